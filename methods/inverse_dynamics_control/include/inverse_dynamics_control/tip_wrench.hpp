// SPDX-License-Identifier: Apache-2.0
/// @file
/// The wrench at the tip that external torques of the joints belong to, and how much of it they tell.
///
///     TipWrench tip(solver, options);
///     if (tip.update(state.q, observer.torques()) == WrenchStatus::kOk) use(tip.wrench());
///     if (tip.unseen() > 0) report(tip.directions());   // near a singularity
///
/// With external torques that are known up to noise of the standard deviation s_j, and a wrench that
/// is expected to be of the size P = diag(force, force, force, torque, torque, torque), the most
/// likely wrench is the damped least squares solution
///
///     w = P u,   u = the minimum of |S^-1 (tau_ext - J^T P u)|^2 + |u|^2.
///
/// The singular values of `S^-1 J^T P` are signal-to-noise ratios: what a wrench of the expected size
/// in that direction does to the torques, by their noise. Of a direction with the ratio x the part
/// x^2 / (1 + x^2) is found, the rest is taken for zero; where x is below one, that is less than half
/// of it, and the direction counts as not seen. At a singularity x is zero: the arm can't feel it.
/// An arm of less than six joints never sees six directions.
#pragma once

#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>

#include "chain_dynamics/owned.hpp"
#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

using inverse_dynamics_solver::WrenchInRoot;

/// Result of an update. Unless it is kOk, the wrench is zero.
enum class WrenchStatus {
  kOk,            ///< wrench() is the estimate, of what unseen() says can be seen
  kNotFinite,     ///< a position, a torque or the Jacobian is NaN or infinite
  kSolverFailed,  ///< the solver threw
  kWrongSize,     ///< an argument hasn't one number per joint
};

/// Text of a message, without a full stop. Real time: no allocation, lock, exception or
/// system call. Threads: safe.
const char* text(WrenchStatus status) noexcept;

/// Assumptions of the estimate.
struct WrenchOptions {
  /// Standard deviation of the external torques, n, finite, > 0; N m (prismatic N). Required;
  /// ContactThresholds::noise has it.
  OwnedVector noise;

  double force = 100.0;  ///< size of the forces that are expected; finite, > 0; N
  double torque = 10.0;  ///< and of the torques about the tip's origin; finite, > 0; N m
};

/// Wrench at the tip from external torques; see the head of this file. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call, with a
/// solver that keeps the same promise.
class TipWrench {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: no solver, one that hasn't the
  /// capability Kinematics, options of the wrong size or value. UninitializedException: the solver
  /// isn't initialized.
  TipWrench(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
            const WrenchOptions& options);

  /// Number n of joints.
  Eigen::Index jointCount() const noexcept { return noise_.size(); }

  /// Takes positions and external torques (n each; those of an ExternalTorqueEstimator).
  WrenchStatus update(const Eigen::Ref<const Eigen::VectorXd>& q,
                      const Eigen::Ref<const Eigen::VectorXd>& torques) noexcept;

  /// The wrench that the tip exerts on its surroundings, at its origin, in the axes of the root frame.
  const WrenchInRoot& wrench() const noexcept { return wrench_; }

  /// Signal-to-noise ratios, 6, the greatest first; see the head of this file.
  const OwnedVector& signalToNoise() const noexcept { return ratio_; }

  /// The directions that they belong to, 6 x 6: column i is a wrench of the expected size (force
  /// [N], then torque [N m], axes of the root frame).
  const chain_dynamics::OwnedMatrix& directions() const noexcept { return directions_; }

  /// How many directions, the last columns of directions(), are below the noise.
  Eigen::Index unseen() const noexcept;

 private:
  void clear() noexcept;

  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  const inverse_dynamics_solver::Kinematics* kinematics_;  // of the solver
  OwnedVector noise_, size_;                               // n; 6: diagonal of P
  chain_dynamics::OwnedMatrix J_, A_;                      // 6 x n; n x 6: S^-1 J^T P
  OwnedVector scaled_;                                     // S^-1 tau_ext
  OwnedVector ratio_;
  chain_dynamics::OwnedMatrix directions_;
  WrenchInRoot wrench_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
