// SPDX-License-Identifier: Apache-2.0
/// @file
/// Gains of joint torques, from the parameters gains.p and gains.d.
#pragma once

#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <string>
#include <vector>

#include "arm.hpp"
#include "changing_gains.hpp"
#include "joint_numbers.hpp"

namespace inverse_dynamics_controllers {

/// Throws inverse_dynamics_solver::InvalidParameterValueException: neither one number nor one per
/// joint.
inline ChangingGains<inverse_dynamics_control::PdGains> pdGains(const Setup& setup) {
  const auto make = [joints = setup.arm.joints](const ParameterValues& values) {
    const auto numbers = [&](const std::string& name) {
      return jointNumbers(name, values.at(name).get<std::vector<double>>(), joints);
    };
    return inverse_dynamics_control::PdGains{numbers("gains.p"), numbers("gains.d")};
  };
  return {setup.node, {"gains.p", "gains.d"}, make};
}

}  // namespace inverse_dynamics_controllers
