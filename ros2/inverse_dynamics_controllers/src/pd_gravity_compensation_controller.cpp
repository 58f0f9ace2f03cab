// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/pd_gravity_compensation_controller.hpp"

#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <inverse_dynamics_controllers/pd_gravity_compensation_controller_parameters.hpp>
#include <memory>

#include "follower.hpp"

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::PdGains;
using inverse_dynamics_control::PdGravityCompensation;

FollowingController::MakeFollower PdGravityCompensationController::declareParameters() {
  const auto parameters =
      std::make_shared<pd_gravity_compensation_controller::ParamListener>(get_node());
  return [parameters](const Setup& setup, const reference_parameters::Params& references) {
    const auto params = parameters->get_params();
    const ReferenceLayout layout(params.reference_interfaces, setup.arm.joints);
    return std::make_unique<FollowerWithGains<PdGravityCompensation, PdGains>>(
        setup, referenceInput(setup, layout, references), pdGains(setup),
        lawOptions(setup, params.friction.source));
  };
}

}  // namespace inverse_dynamics_controllers
