// SPDX-License-Identifier: Apache-2.0
#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

#include <string>
#include <utility>

#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace ur10_inverse_dynamics_solver {
inline namespace v2 {
namespace {

const char* const kModel = "ur10_identified";

}  // namespace

auto InverseDynamicsSolverUR10::configure(
    const inverse_dynamics_solver::Configuration& configuration) -> JointInfo {
  chain_dynamics::Model model = rigid_body_inverse_dynamics_solver::readModel(kModel);

  // An overlaid workspace may bring another file of that name.
  if (model.chain.jointCount() != NUMBER_OF_JOINTS ||
      model.drive_gains.size() != NUMBER_OF_JOINTS) {
    throw inverse_dynamics_solver::Exception(
        std::string("model ") + kModel, "not a UR10's",
        std::to_string(NUMBER_OF_JOINTS) + " joints with a drive gain each",
        std::to_string(model.chain.jointCount()) + " joints, " +
            std::to_string(model.drive_gains.size()) + " drive gains",
        "for another robot use rigid_body_inverse_dynamics_solver with its model");
  }
  return use(std::move(model), configuration);
}

}  // namespace v2
}  // namespace ur10_inverse_dynamics_solver
