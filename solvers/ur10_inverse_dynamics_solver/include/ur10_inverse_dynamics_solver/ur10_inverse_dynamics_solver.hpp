// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of the Universal Robots UR10 (CB series), identified at motor-current level.
///
///     ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10 solver;
///     solver.initialize();                                     // no parameter is needed
///     Eigen::VectorXd tau = solver.getTorques(q, qd, qdd);     // N m, with friction
///     Eigen::VectorXd i = solver.getCurrents(q, qd, qdd);      // A: tau = K i
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace ur10_inverse_dynamics_solver {
inline namespace v2 {

// The names that programs written for the solver of this name know.
// NOLINTBEGIN(readability-identifier-naming)
inline constexpr unsigned short int NUMBER_OF_JOINTS = 6;
using Vector6d = Eigen::Matrix<double, NUMBER_OF_JOINTS, 1>;
using Matrix6d = Eigen::Matrix<double, NUMBER_OF_JOINTS, NUMBER_OF_JOINTS>;
// NOLINTEND(readability-identifier-naming)

/// The UR10 of Petrone, Ferrentino, Chiacchio, IEEE Transactions on Industrial Informatics, 2025,
/// doi 10.1109/TII.2025.3534415: the engine with the file ur10_identified.yaml of the package
/// inverse_dynamics_robots, which holds the numbers.
///
/// Each joint was identified by itself, so H is neither symmetric nor positive definite:
/// inertiaIsPhysical() is false; good for feed-forward torques, unfit for forward dynamics.
/// Friction is not zero at rest.
///
/// Parameters: `gravity`, `friction` [configuration.hpp] and `payload` [payload.hpp]. Others have no
/// meaning here, and a robot description is only compared with the model: warnings() names what
/// isn't included.
///
/// Real time: methods that return by value allocate the result; the others, inherited, don't.
/// Threads: const methods are safe.
class InverseDynamicsSolverUR10
    : public rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody,
      public inverse_dynamics_solver::MotorCurrents {
 protected:
  JointInfo configure(const inverse_dynamics_solver::Configuration& configuration) override;
  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  Gains driveGains() const override { return Gains(model().drive_gains.data(), jointCount()); }
};

}  // namespace v2
}  // namespace ur10_inverse_dynamics_solver
