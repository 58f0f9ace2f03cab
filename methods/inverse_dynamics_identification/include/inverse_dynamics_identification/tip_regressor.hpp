// SPDX-License-Identifier: Apache-2.0

/// @file
/// Torques of a body at the tip as a linear function of its ten parameters, with any solver that
/// knows the tip's kinematics.
///
///     TipRegressor regressor(solver);
///     regressor.compute(q, qd, qdd, Y);                    // n x 10
///     tau += Y * inTipFrame(body).toVector();              // what carrying the body adds
///
/// The force on the body is linear in its parameters [chain_dynamics/regressor.hpp]; the transposed
/// Jacobian of the tip takes it to the joints.

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Regressor of a body in the tip frame; without friction that grows with load. Not thread-safe.
class TipRegressor {
 public:
  /// Gravity and acceleration of the base are those that the solver has now.
  ///
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  no solver, or one without the
  ///     capabilities Kinematics and VariableGravity; UninitializedException.
  explicit TipRegressor(
      std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver);

  /// `Y(q, qd, qdd)`: torques per unit of [m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz], I about
  /// the origin of the tip frame.
  ///
  /// @param q,qd,qdd  n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).
  /// @param[out] Y    n x 10; N m (prismatic N) per unit.
  /// Throws what the solver throws. Real time: as the solver: no allocation, lock or system call.
  void compute(const inverse_dynamics_solver::ConstVectorRef& q,
               const inverse_dynamics_solver::ConstVectorRef& qd,
               const inverse_dynamics_solver::ConstVectorRef& qdd,
               inverse_dynamics_solver::MatrixRef Y);

 private:
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  const inverse_dynamics_solver::Kinematics* kinematics_;  // of the solver
  Eigen::Vector3d gravity_;                                // less the acceleration of the base
  chain_dynamics::OwnedMatrix J_, dJ_;                     // 6 x n
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
