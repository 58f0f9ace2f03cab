// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot was identified at motor-current level.
///
///     if (auto* motors = dynamic_cast<const MotorCurrents*>(solver.get())) {
///       Eigen::VectorXd i = motors->getCurrents(q, qd, qdd);   // solver->getTorques(q, qd, qdd) =
///       K i
///     }
#pragma once

#include <Eigen/Core>

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The motor currents of each term of the dynamics: torque = K current, K the drive gains.
///
/// Not a base of InverseDynamicsSolver: a solver that has it derives from both. Arguments, order,
/// real-time and thread promises, and errors (uninitialized, wrong size) are those of the solver's
/// method of the same term.
class MotorCurrents {
 public:
  virtual ~MotorCurrents();

  /// Currents of a motion [A], n: `K^-1 tau`. All terms, friction too unless it is switched off.
  virtual Eigen::VectorXd getCurrents(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::VectorXd>& qd,
                                      const Eigen::Ref<const Eigen::VectorXd>& qdd) const = 0;

  /// Current per acceleration [A s^2/rad], n x n: `K^-1 H(q)`.
  virtual Eigen::MatrixXd getInertiaCurrents(const Eigen::Ref<const Eigen::VectorXd>& q) const = 0;

  /// Coriolis and centrifugal currents [A], n: `K^-1 C(q, qd) qd`.
  virtual Eigen::VectorXd getCoriolisCurrents(
      const Eigen::Ref<const Eigen::VectorXd>& q,
      const Eigen::Ref<const Eigen::VectorXd>& qd) const = 0;

  /// Currents that hold the robot still [A], n: `K^-1 g(q)`.
  virtual Eigen::VectorXd getGravityCurrents(const Eigen::Ref<const Eigen::VectorXd>& q) const = 0;

  /// Currents against friction [A], n: `K^-1 f(qd)`.
  virtual Eigen::VectorXd getFrictionCurrents(
      const Eigen::Ref<const Eigen::VectorXd>& qd) const = 0;

  /// Drive gains K [N m/A; prismatic N/A], n x n, diagonal.
  virtual Eigen::MatrixXd getDriveGainsMatrix() const = 0;

 protected:
  MotorCurrents() = default;
  MotorCurrents(const MotorCurrents&) = default;
  MotorCurrents& operator=(const MotorCurrents&) = default;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
