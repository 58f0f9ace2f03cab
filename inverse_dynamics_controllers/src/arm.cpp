// SPDX-License-Identifier: Apache-2.0
#include "arm.hpp"

#include <chain_dynamics/text.hpp>
#include <inverse_dynamics_control/damping.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>

#include "robot_description.hpp"

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;
using inverse_dynamics_control::FrictionSource;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;

namespace {

// The solver's names in the hardware: the given ones, which must be as many; none: its own.
std::vector<std::string> hardwareNames(const std::vector<std::string>& given,
                                       const std::vector<std::string>& solvers) {
  if (given.empty() || given.size() == solvers.size()) return given.empty() ? solvers : given;
  throw InvalidParameterValueException(
      errorText("parameter 'joints'", "wrong number of names",
                std::to_string(solvers.size()) + ", in the order of " + joined(solvers),
                std::to_string(given.size()) + " (" + joined(given) + ")", "correct them"));
}

FrictionSource frictionSource(const std::string& name) {
  if (name == "reference_velocity") return FrictionSource::kReferenceVelocity;
  if (name == "measured_velocity") return FrictionSource::kMeasuredVelocity;
  return FrictionSource::kNone;
}

double periodOf(const ArmParameters& parameters, unsigned update_rate) {
  if (parameters.period > 0) return parameters.period;
  if (update_rate > 0) return 1.0 / update_rate;
  throw ParameterUninitializedException(errorText(
      "parameter 'period'", "not set", "the period of the control loop [s], for damping.rate",
      "nothing", "set it, or 'update_rate' [Hz], or 'damping.values'"));
}

Eigen::VectorXd dampingOf(const Arm& arm, const ArmParameters& parameters, unsigned update_rate) {
  if (!parameters.damping.empty()) {
    return jointNumbers("damping.values", parameters.damping, arm.joints);
  }
  if (!arm.solver->inertiaIsPhysical()) {
    throw InvalidParameterValueException(errorText(
        "parameter 'damping.values'", "not set", "a damping of each joint [N m s/rad]", "nothing",
        "set it: damping.rate needs a solver whose inertiaIsPhysical() is true, "
        "and that of " +
            parameters.plugin_name + " is false"));
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(arm.solver->jointCount());
  const Eigen::VectorXd posture =
      jointNumbers("damping.posture", parameters.damping_posture, arm.joints, zero);
  return inverse_dynamics_control::dampingFor(*arm.solver, posture, parameters.damping_rate,
                                              periodOf(parameters, update_rate));
}

}  // namespace

Arm makeArm(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
            const ArmParameters& parameters, const std::string& managers_description) {
  const inverse_dynamics_solver::SolverLoader loader;
  if (parameters.plugin_name.empty()) {
    throw ParameterUninitializedException(
        errorText("parameter 'plugin_name'", "not set", "a solver, package/Class", "nothing",
                  "set it to one of " + joined(loader.availableSolvers())));
  }
  const auto solver = loader.load(parameters.plugin_name);
  const std::string description =
      findRobotDescription(node, parameters.robot_description, managers_description,
                           parameters.robot_description_timeout);
  inverse_dynamics_solver::initializeStrictly(*solver, node->get_node_parameters_interface(), "ids",
                                              description);
  for (const std::string& warning : solver->warnings()) {
    RCLCPP_WARN(node->get_logger(), "%s: %s", parameters.plugin_name.c_str(), warning.c_str());
  }
  const std::vector<std::string> joints = hardwareNames(parameters.joints, solver->jointNames());
  return {solver, joints, urdfLimits(description, joints)};
}

LawOptions lawOptions(const Arm& arm, const ArmParameters& parameters, unsigned update_rate) {
  LawOptions options;
  options.compensated = parameters.compensated;
  options.friction = parameters.friction;
  options.friction.source = frictionSource(parameters.friction_source);
  options.limits.effort =
      jointNumbers("limits.effort", parameters.effort, arm.joints, arm.limits.effort);
  if (parameters.effort.empty() && !options.limits.effort.allFinite()) {
    throw ParameterUninitializedException(errorText(
        "parameter 'limits.effort'", "not set",
        "limits of effort [N m], here or in the robot description", "neither for all joints",
        "set it; .inf where the robot limits its effort by itself"));
  }
  options.limits.rate =
      jointNumbers("limits.effort_rate", parameters.effort_rate, arm.joints, Eigen::VectorXd());
  options.damping = dampingOf(arm, parameters, update_rate);
  return options;
}

}  // namespace inverse_dynamics_controllers
