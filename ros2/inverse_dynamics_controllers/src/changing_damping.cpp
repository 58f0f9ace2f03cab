// SPDX-License-Identifier: Apache-2.0
#include "changing_damping.hpp"

#include <cmath>
#include <cstddef>
#include <inverse_dynamics_control/damping.hpp>
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
const char* const kPosture = "damping.posture";

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

Eigen::VectorXd dampingOf(const Setup& setup, const ParameterValues& parameters) {
  const Arm& arm = setup.arm;
  const auto values = parameters.at(kValues).get<Numbers>();
  if (!values.empty()) return givenDamping(values, arm);
  if (!arm.solver->inertiaIsPhysical()) {
    throw InvalidParameterValueException(
        "parameter 'damping.values'", "not set", "a damping of each joint [N m s/rad]", "nothing",
        "set it: damping.rate needs a solver whose inertiaIsPhysical() is true, "
        "and that of " +
            setup.parameters.plugin_name + " is false");
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(arm.solver->jointCount());
  return inverse_dynamics_control::dampingFor(
      *arm.solver, jointNumbers(kPosture, parameters.at(kPosture).get<Numbers>(), arm.joints, zero),
      parameters.at(kRate).get<double>(), setup.period);
}

}  // namespace

ChangingGains<Eigen::VectorXd> changingDamping(const Setup& setup) {
  Setup kept = setup;
  kept.node.reset();  // it keeps what asks for the damping, and must not be kept by it
  return {setup.node, {kValues, kRate, kPosture}, [kept](const ParameterValues& parameters) {
            return dampingOf(kept, parameters);
          }};
}

}  // namespace inverse_dynamics_controllers
