// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot was identified at motor-current level.
///
///     if (auto* motors = dynamic_cast<const MotorCurrents*>(solver.get())) {
///       Eigen::VectorXd i = motors->getCurrents(q, qd, qdd);   // K i = getTorques(q, qd, qdd)
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The motor currents of a motion: torque = K current, K the drive gains. Those of a term are its torques
/// divided by K.
class MotorCurrents : public Capability {
 public:
  ~MotorCurrents() override;

  /// Currents of a motion [A], n: `K^-1 tau`. All terms, friction too unless it is switched off.
  Eigen::VectorXd getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                              const ConstVectorRef& qdd) const {
    Eigen::VectorXd i(gains("getCurrents").size());
    getCurrents(q, qd, qdd, i);
    return i;
  }
  /// The same into memory of the caller, without allocation.
  void getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                   VectorRef i) const;

  /// Drive gains K [N m/A; prismatic N/A], n x n, diagonal.
  Eigen::MatrixXd getDriveGainsMatrix() const { return gains("getDriveGainsMatrix").asDiagonal(); }

 protected:
  using Gains = Eigen::Map<const Eigen::VectorXd>;

  /// The diagonal of K, n numbers other than zero. Called after a successful initialize().
  virtual Gains driveGains() const = 0;

 private:
  Gains gains(const char* method) const;  // throws UninitializedException
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
