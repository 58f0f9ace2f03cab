// SPDX-License-Identifier: Apache-2.0
#include "franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.hpp"

#include <inverse_dynamics_solver/configuration.hpp>

#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace franka_inria_inverse_dynamics_solver {
inline namespace v2 {

auto InverseDynamicsSolverFrankaInria::configure(
    const inverse_dynamics_solver::Configuration& configuration) -> JointInfo {
  return use(rigid_body_inverse_dynamics_solver::readModel("franka_inria_identified"),
             configuration);
}

}  // namespace v2
}  // namespace franka_inria_inverse_dynamics_solver
