// SPDX-License-Identifier: Apache-2.0
#include "arm.hpp"

#include <rcl/arguments.h>
#include <rcl_yaml_param_parser/parser.h>

#include <chain_dynamics/text.hpp>
#include <cmath>
#include <inverse_dynamics_control/compensated.hpp>
#include <inverse_dynamics_control/control_law.hpp>
#include <inverse_dynamics_control/friction_compensation.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <memory>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rclcpp/exceptions.hpp>
#include <rclcpp/parameter.hpp>
#include <rclcpp/parameter_map.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "changing_damping.hpp"

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;
using inverse_dynamics_control::FrictionSource;
using inverse_dynamics_control::jointNumbers;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;

namespace {

// The solver's names in the hardware: the given ones, which must be as many; none: its own.
std::vector<std::string> hardwareNames(const std::string& parameter,
                                       const std::vector<std::string>& given,
                                       const std::vector<std::string>& solvers) {
  if (given.empty() || given.size() == solvers.size()) return given.empty() ? solvers : given;
  throw InvalidParameterValueException(
      "parameter '" + parameter + "'", "wrong number of names",
      std::to_string(solvers.size()) + ", in the order of " + joined(solvers),
      std::to_string(given.size()) + " (" + joined(given) + ")", "correct them");
}

// Names of parameters in sections that other nodes read, too, such as `/**`, and in none of this node alone.
std::set<std::string> sharedParameters(rclcpp_lifecycle::LifecycleNode& node) {
  const rclcpp::NodeOptions& options = node.get_node_options();
  std::vector<const rcl_arguments_t*> sources = {&options.get_rcl_node_options()->arguments};
  if (options.use_global_arguments()) {
    const auto context = node.get_node_base_interface()->get_context()->get_rcl_context();
    sources.push_back(&context->global_arguments);
  }
  std::set<std::string> shared, own;
  for (const rcl_arguments_t* const source : sources) {
    rcl_params_t* given = nullptr;
    if (rcl_arguments_get_param_overrides(source, &given) != RCL_RET_OK || given == nullptr)
      continue;
    const rclcpp::ParameterMap sections = rclcpp::parameter_map_from(given);
    rcl_yaml_node_struct_fini(given);
    for (const auto& [section, parameters] : sections) {
      const std::string reader = section.substr(section.rfind('/') + 1);
      if (reader != node.get_name() && reader.find('*') == std::string::npos) continue;
      for (const rclcpp::Parameter& parameter : parameters) {
        (reader == node.get_name() ? own : shared).insert(parameter.get_name());
      }
    }
  }
  for (const std::string& name : own) shared.erase(name);
  return shared;
}

// Refuses parameters that the controller doesn't declare; warns of those in sections for other nodes, too.
void rejectUndeclared(rclcpp_lifecycle::LifecycleNode& node) {
  const auto& parameters = *node.get_node_parameters_interface();
  const std::vector<std::string> declared = parameters.list_parameters({}, 0).names;
  const std::set<std::string> shared = sharedParameters(node);
  for (const auto& [name, value] : parameters.get_parameter_overrides()) {
    try {
      inverse_dynamics_solver::rejectUndeclared({name}, declared);
    } catch (const InvalidParameterValueException& error) {
      if (shared.count(name) == 0) throw;
      RCLCPP_WARN(node.get_logger(), "%s; ignored, since its section is for other nodes, too",
                  error.what());
    }
  }
}

// Declares parameters that are read by others than this package: by the solver, which alone knows
// what it has; by the thread of a controller that isn't run in the manager's; by the manager's
// spawner, in the same file.
void declareParametersOfOthers(rclcpp::node_interfaces::NodeParametersInterface& node) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.dynamic_typing = true;
  for (const auto& [name, value] : node.get_parameter_overrides()) {
    const std::string group = name.substr(0, name.find('.') + 1);
    const bool of_others = group == "ids." || group == "async_parameters." || name == "type" ||
                           name == "fallback_controllers";
    if (of_others && !node.has_parameter(name)) node.declare_parameter(name, value, descriptor);
  }
}

// That of the update rate [Hz], with which a stated one must agree; 0: not known, or not stated.
double samplingPeriod(double stated, unsigned update_rate) {
  constexpr double kRounded = 0.01;  // of a stated period: 0.0167 s for 60 Hz
  if (update_rate == 0) {
    if (stated > 0) return stated;
    throw ParameterUninitializedException(
        "parameter 'update_rate'", "not set",
        "the controller manager's update rate [Hz], which humble's doesn't tell its controllers",
        "nothing", "set it for the controller, too");
  }
  const double period = 1.0 / update_rate;
  if (stated == 0 || std::abs(stated - period) <= kRounded * period) return period;
  const auto text = [](double seconds) { return chain_dynamics::numberText(seconds) + " s"; };
  throw InvalidParameterValueException(
      "parameter 'period'", "not that of the control loop",
      text(period) + " (update_rate is " + std::to_string(update_rate) + " Hz)", text(stated),
      "leave it out");
}

// The spawner hands this parameter on to the manager.
bool hasFallback(const rclcpp_lifecycle::LifecycleNode& node) {
  rclcpp::Parameter fallback;
  return node.get_parameter("fallback_controllers", fallback) &&
         fallback.get_type() == rclcpp::PARAMETER_STRING_ARRAY &&
         !fallback.as_string_array().empty();
}

FrictionSource frictionSource(const std::string& name) {
  if (name == "reference_velocity") return FrictionSource::kReferenceVelocity;
  if (name == "measured_velocity") return FrictionSource::kMeasuredVelocity;
  return FrictionSource::kNone;
}

}  // namespace

std::string Setup::tip() const { return arm.solver->tipNames().front(); }

ArmSource::ArmSource(std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node, Use use)
    : node_(std::move(node)),
      parameters_(std::make_shared<arm_parameters::ParamListener>(node_)),
      law_(use == Use::kCommand ? std::make_shared<law_parameters::ParamListener>(node_) : nullptr),
      description_(node_) {
  auto& parameters = *node_->get_node_parameters_interface();
  declareParametersOfOthers(parameters);
  suggesting_ =
      inverse_dynamics_solver::suggestDeclared<rclcpp::exceptions::ParameterNotDeclaredException>(
          parameters);
}

Setup ArmSource::setup(const std::string& managers_description, unsigned update_rate) const {
  rejectUndeclared(*node_);
  const ArmParameters parameters = parameters_->get_params();
  const inverse_dynamics_solver::SolverLoader loader;
  if (parameters.plugin_name.empty()) {
    throw ParameterUninitializedException("parameter 'plugin_name'", "not set",
                                          "a solver, package/Class", "nothing",
                                          "set it to one of " + joined(loader.availableSolvers()));
  }
  const auto solver = loader.load(parameters.plugin_name);
  const std::string description =
      description_.find(parameters.robot_description, managers_description);
  const inverse_dynamics_solver::Parameters given(node_->get_node_parameters_interface());
  solver->initialize(given.strict(), "ids", description);
  for (const std::string& warning : solver->warnings()) {
    RCLCPP_WARN(node_->get_logger(), "%s: %s", parameters.plugin_name.c_str(), warning.c_str());
  }
  const std::vector<std::string> joints =
      hardwareNames("joints", parameters.joints, solver->jointNames());
  const LawParameters law = law_ ? law_->get_params() : LawParameters();
  std::vector<std::string> commands = hardwareNames("command_joints", law.command_joints, joints);
  for (std::string& command : commands) command += "/" + law.command_interface;
  return {node_,
          parameters,
          law,
          {solver, joints, std::move(commands),
           inverse_dynamics_control::describedLimits(description, joints)},
          samplingPeriod(parameters.period, update_rate),
          hasFallback(*node_)};
}

inverse_dynamics_control::Compensated compensatedByRobot(const Setup& setup) {
  const auto& compensated = setup.parameters.compensated_by_robot;
  const auto shares = [&](const char* term, const std::vector<double>& given, bool of_all) {
    const std::string name = std::string("compensated_by_robot.shares.") + term;
    if (given.empty()) return inverse_dynamics_control::Shares(of_all);
    return inverse_dynamics_control::Shares(jointNumbers(name, given, setup.arm.joints));
  };
  const auto& given = compensated.shares;
  inverse_dynamics_control::Compensated found;
  found.gravity = shares("gravity", given.gravity, compensated.gravity);
  found.coriolis = compensated.coriolis;
  found.friction = shares("coulomb", given.coulomb, compensated.friction);
  if (!given.viscous.empty()) found.viscous = shares("viscous", given.viscous, false);
  return found;
}

LawOptions lawOptions(const Setup& setup, const std::string& friction_source) {
  const Arm& arm = setup.arm;
  const LawParameters& law = setup.law;
  LawOptions options;
  options.compensated = compensatedByRobot(setup);
  options.friction.source = frictionSource(friction_source);
  options.friction.dead_band = law.friction.dead_band;
  options.friction.blend = law.friction.blend;
  options.friction.scale = law.friction.scale;
  options.limits.effort =
      jointNumbers("limits.effort", law.limits.effort, arm.joints, arm.limits.effort);
  if (law.limits.effort.empty() && !arm.limits.unknown.empty()) {
    throw InvalidParameterValueException(
        "parameter 'joints'", "not in the robot description",
        "its names of the chain's joints (" + joined(arm.solver->jointNames()) + ")",
        joined(arm.limits.unknown),
        "set 'joints' to them, or 'limits.effort' if the hardware names its joints otherwise");
  }
  if (law.limits.effort.empty() && !arm.limits.effort.allFinite()) {
    throw ParameterUninitializedException(
        "parameter 'limits.effort'", "not set",
        "limits of effort [N m], here or in the robot description", "neither for all joints",
        "set it; .inf where the robot limits its effort by itself");
  }
  options.limits.rate = jointNumbers("limits.effort_rate", law.limits.effort_rate, arm.joints, {});
  const Damping damping = changingDamping(setup).initial();
  options.damping = damping.of_joints;
  options.damping_rate = damping.rate;
  return options;
}

}  // namespace inverse_dynamics_controllers
