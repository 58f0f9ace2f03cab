// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of the Franka Emika Panda (FER), identified, with friction.
///
///     franka_inria_inverse_dynamics_solver::InverseDynamicsSolverFrankaInria solver;
///     solver.initialize();                                     // no parameter is needed
///     Eigen::VectorXd tau = solver.getTorques(q, qd, qdd);     // N m, with friction
#pragma once

#include <inverse_dynamics_solver/configuration.hpp>

#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace franka_inria_inverse_dynamics_solver {
inline namespace v2 {

/// The Panda of Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca, IEEE Robotics and Automation
/// Letters, 2019, doi 10.1109/LRA.2019.2931248: the engine with the file
/// franka_inria_identified.yaml of the package inverse_dynamics_robots, where the figures stand.
/// Without hand and payload; the last joint carries the flange.
///
/// The published coefficients are those of no rigid body, so inertiaIsPhysical() is false. The
/// consistent parameters of the same authors are the model franka_gaz2019_feasible of
/// rigid_body_inverse_dynamics_solver.
///
/// Parameters: `gravity`, `friction` [configuration.hpp] and `payload` [payload.hpp]. Others have no
/// meaning here, and a robot description is only compared with the model: warnings() names what
/// isn't included.
class InverseDynamicsSolverFrankaInria
    : public rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody {
 protected:
  JointInfo configure(const inverse_dynamics_solver::Configuration& configuration) override;
};

}  // namespace v2
}  // namespace franka_inria_inverse_dynamics_solver
