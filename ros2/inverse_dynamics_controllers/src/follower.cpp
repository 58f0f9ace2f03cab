// SPDX-License-Identifier: Apache-2.0
#include "follower.hpp"

#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <inverse_dynamics_control/reference_guard.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::jointNumbers;
using inverse_dynamics_control::ReferenceGuard;
using inverse_dynamics_control::ReferenceLimits;
using inverse_dynamics_control::Steps;

ChangingGains<inverse_dynamics_control::PdGains> pdGains(const Setup& setup) {
  const auto make = [joints = setup.arm.joints](const ParameterValues& values) {
    const auto numbers = [&](const std::string& name) {
      return jointNumbers(name, values.at(name).get<std::vector<double>>(), joints);
    };
    return inverse_dynamics_control::PdGains{numbers("gains.p"), numbers("gains.d")};
  };
  return {setup.node, {"gains.p", "gains.d"}, make};
}

ReferenceInput referenceInput(const Setup& setup, const ReferenceLayout& layout,
                              const reference_parameters::Params& params) {
  const std::vector<std::string>& joints = setup.arm.joints;
  const ReferenceLimits& urdf = setup.arm.limits.reference;
  const auto& own = params.limits;
  const ReferenceLimits limits{
      jointNumbers("limits.position_lower", own.position_lower, joints, urdf.lower),
      jointNumbers("limits.position_upper", own.position_upper, joints, urdf.upper),
      jointNumbers("limits.velocity", own.velocity, joints, urdf.velocity),
      jointNumbers("limits.acceleration", own.acceleration, joints, urdf.acceleration),
      jointNumbers("limits.acceleration", own.acceleration, joints, urdf.deceleration)};
  const ReferenceGuard guard(limits,
                             jointNumbers("stop_deceleration", params.stop_deceleration, joints),
                             joints, setup.arm.solver->jointTypes(),
                             params.reference_steps == "ramp" ? Steps::kRamp : Steps::kRefuse);
  return {setup.node, layout, joints, guard, params.reference_timeout};
}

}  // namespace inverse_dynamics_controllers
