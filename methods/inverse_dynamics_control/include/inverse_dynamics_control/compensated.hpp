// SPDX-License-Identifier: Apache-2.0
/// @file
/// Terms that the robot compensates by itself, so that nothing is compensated twice.
///
///     Compensated panda;          // its effort interface adds gravity and friction on its own
///     panda.gravity = true;
///     panda.friction = true;
///
///     Compensated ur;             // direct torque control: gravity, and shares of friction
///     ur.gravity = true;
///     ur.friction = coulomb_scale;   // of each joint; 0.8 would be that of all
///     ur.viscous = viscous_scale;
#pragma once

#include <Eigen/Core>
#include <optional>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Shares, 0 to 1: one of each joint, or one number (or truth) of all joints.
class Shares {
 public:
  Shares(double of_all = 0) : values_(Eigen::VectorXd::Constant(1, of_all)) {}  // NOLINT: implicit
  template <class Vector>
  Shares(const Eigen::MatrixBase<Vector>& of_each) : values_(of_each) {}  // NOLINT: implicit

  /// One number, or one of each joint.
  const chain_dynamics::OwnedVector& values() const { return values_; }

 private:
  chain_dynamics::OwnedVector values_;
};

/// Shares of terms that every law of this package leaves out, as the robot's own controller adds them.
struct Compensated {
  Shares gravity = 0.0;   ///< g(q)
  Shares coriolis = 0.0;  ///< C(q, qd) qd
  Shares friction = 0.0;  ///< f(qd), but for what `viscous` says
  /// Of the part of friction that is proportional to the velocity; empty: as `friction`.
  std::optional<Shares> viscous = {};
};

}  // namespace v2
}  // namespace inverse_dynamics_control
