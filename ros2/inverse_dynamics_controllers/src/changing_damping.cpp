// SPDX-License-Identifier: Apache-2.0
#include "changing_damping.hpp"

#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {
namespace {

using inverse_dynamics_control::jointNumbers;
using inverse_dynamics_solver::InvalidParameterValueException;
using Numbers = std::vector<double>;

const char* const kValues = "damping.values";
const char* const kRate = "damping.rate";

// The joints' numbers, finite and >= 0.
Eigen::VectorXd givenDamping(const Numbers& values, const Arm& arm) {
  Eigen::VectorXd damping = jointNumbers(kValues, values, arm.joints);
  for (Eigen::Index j = 0; j < damping.size(); ++j) {
    if (damping[j] >= 0 && std::isfinite(damping[j])) continue;
    throw InvalidParameterValueException(
        "parameter 'damping.values': joint " + arm.joints[static_cast<std::size_t>(j)],
        "wrong value", "a finite number, 0 or more [N m s/rad]", std::to_string(damping[j]),
        "correct this number");
  }
  return damping;
}

Damping dampingOf(const Setup& setup, const ParameterValues& parameters) {
  const Arm& arm = setup.arm;
  const auto values = parameters.at(kValues).get<Numbers>();
  if (!values.empty()) return {givenDamping(values, arm), 0.0};
  if (!arm.solver->inertiaIsPhysical()) {
    throw InvalidParameterValueException(
        "parameter 'damping.values'", "not set", "a damping of each joint [N m s/rad]", "nothing",
        "set it: damping.rate needs a solver whose inertiaIsPhysical() is true, "
        "and that of " +
            setup.parameters.plugin_name + " is false");
  }
  const auto rate = parameters.at(kRate).get<double>();
  if (rate * setup.period > 1.0) {
    const auto text = [](double number) { return chain_dynamics::numberText(number) + " 1/s"; };
    throw InvalidParameterValueException("parameter 'damping.rate'", "too fast",
                                         "at most 1 / period, " + text(1.0 / setup.period),
                                         text(rate), "lower it");
  }
  return {Eigen::VectorXd::Zero(arm.solver->jointCount()), rate};
}

}  // namespace

ChangingGains<Damping> changingDamping(const Setup& setup) {
  Setup kept = setup;
  kept.node.reset();  // it keeps what asks for the damping, and must not be kept by it
  return {setup.node, {kValues, kRate}, [kept](const ParameterValues& parameters) {
            return dampingOf(kept, parameters);
          }};
}

}  // namespace inverse_dynamics_controllers
