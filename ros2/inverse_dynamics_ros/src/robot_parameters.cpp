// SPDX-License-Identifier: Apache-2.0

#include "robot_parameters.hpp"

#include <chain_dynamics/error.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <fstream>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_ros/robot_parameters.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <memory>
#include <optional>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rclcpp/parameter.hpp>
#include <sstream>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::RunConfiguration;
using inverse_dynamics_evaluation::SolverParameters;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Parameters;

// An empty text or list is one that isn't given.
template <class T>
std::optional<T> givenOf(const Parameters& given, const std::string& name) {
  auto value = given.get<T>(name);
  return value && value->empty() ? std::nullopt : value;
}

// The run configuration with its fields replaced by given parameters.
RunConfiguration configurationOf(const Parameters& given) {
  using Text = std::string;
  const auto name = givenOf<Text>(given, "robot");
  RunConfiguration robot =
      name ? inverse_dynamics_evaluation::readRunConfiguration(*name) : RunConfiguration();
  const auto replace = [&](const Text& parameter, auto& field) {
    const auto value = givenOf<std::decay_t<decltype(field)>>(given, parameter);
    if (!value) return;
    field = *value;
    robot.parameters_of_node.insert(parameter);
  };
  replace("plugin_name", robot.plugin);
  replace("joints", robot.joints);
  replace("effort", robot.effort);
  replace("drive_gains", robot.drive_gains);
  replaceAccelerations(robot, givenOf<Text>(given, "accelerations"), given.get<double>("cutoff"));
  if (givenOf<Text>(given, "robot_description")) replaceDescription(robot, "");
  return robot;
}

// Those of the run configuration, and those given below `ids.` instead of them.
Parameters solverParametersOf(const RunConfiguration& robot, const Parameters& given) {
  const std::string prefix = kSolverNamespace + ".";
  SolverParameters all;
  for (const auto& [name, value] : inverse_dynamics_evaluation::solverParameters(robot)) {
    all[prefix + name] = value;
  }
  for (const std::string& name : given.names()) {
    if (name.rfind(prefix, 0) == 0) all[name] = *given.find(name);
  }
  return all;
}

// None if there is no description, or if it can't be read.
std::optional<chain_dynamics::RobotDescription> described(const std::string& description) {
  try {
    return description.empty() ? std::nullopt
                               : std::optional(chain_dynamics::robotFromUrdf(description));
  } catch (const chain_dynamics::ModelError&) {
    return std::nullopt;  // a solver with its own model takes no notice of it either
  }
}

}  // namespace

void declareRobotParameters(rclcpp::Node& node) {
  const robot_parameters::ParamListener read_only(&node);
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  for (const auto& [name, value] : overrides) {
    if (name.rfind(kSolverNamespace + ".", 0) != 0) continue;
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.read_only = true;
    descriptor.dynamic_typing = true;  // the solver checks types
    node.declare_parameter(name, value, descriptor);
  }
}

Parameters givenParameters(rclcpp::Node& node, const std::string& prefix) {
  SolverParameters given;
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  for (const auto& [name, value] : overrides) {
    if (name.rfind(prefix, 0) != 0) continue;
    const auto found =
        inverse_dynamics_solver::detail::valueOf(name, rclcpp::Parameter(name, value));
    if (found) given.emplace(name.substr(prefix.size()), *found);
  }
  return given;
}

NodeRobot::NodeRobot(const Parameters& given)
    : configuration_(configurationOf(given)),
      description_(given.get<std::string>("robot_description").value_or("")),
      solver_parameters_(solverParametersOf(configuration_, given)) {}

std::string NodeRobot::description() const {
  if (configuration_.urdf.empty()) return description_;
  std::ifstream file(configuration_.urdf);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw UserError(configuration_.urdf, "a robot description", "a file that can't be read",
                    "correct its permissions");
  }
  return text.str();
}

std::shared_ptr<InverseDynamicsSolver> NodeRobot::makeSolver(const std::string& description) const {
  const inverse_dynamics_solver::SolverLoader loader;
  if (configuration_.plugin.empty()) {
    throw UserError("parameter 'plugin_name'", "a solver, package/Class", "nothing",
                    "set it to one of " +
                        inverse_dynamics_evaluation::listed(loader.availableSolvers()) +
                        ", or set 'robot' to a run configuration");
  }
  const auto solver = loader.load(configuration_.plugin);
  solver->initialize(solver_parameters_.strict(), kSolverNamespace, description);
  return solver;
}

std::string NodeRobot::statedLink(const std::string& parameter) const {
  const auto value = solver_parameters_.find(kSolverNamespace + "." + parameter);
  if (value && std::holds_alternative<std::vector<std::string>>(*value)) {
    return chain_dynamics::joined(std::get<std::vector<std::string>>(*value));
  }
  return solver_parameters_.get<std::string>(kSolverNamespace + "." + parameter).value_or("");
}

std::string NodeRobot::name(const std::string& description) const {
  const auto robot = configuration_.name.empty() ? described(description) : std::nullopt;
  return robot ? robot->name : configuration_.name;
}

std::string NodeRobot::rootLink(const std::string& description) const {
  const std::string stated = statedLink("root");
  const auto robot = stated.empty() ? described(description) : std::nullopt;
  return robot ? robot->links[robot->root].name : stated;
}

std::string NodeRobot::tipLink(const std::string& description,
                               const std::vector<std::string>& tips) const {
  if (!tips.empty() && !tips.front().empty()) return tips.front();
  std::string stated = statedLink("tip");
  if (stated == "*") stated.clear();  // of a chain, whose only leaf is meant
  const auto robot = stated.empty() ? described(description) : std::nullopt;
  if (!robot) return stated;
  const std::size_t root = robot->linkIndex(rootLink(description));
  if (root == chain_dynamics::RobotDescription::kNone) return "";
  std::vector<std::string> leaves;
  for (const std::size_t link : robot->linksBelow(root)) {
    if (robot->links[link].child_joints.empty()) leaves.push_back(robot->links[link].name);
  }
  return leaves.size() == 1 ? leaves.front() : "";
}

std::vector<std::string> torqueUnits(const InverseDynamicsSolver& solver) {
  std::vector<std::string> units;
  for (const chain_dynamics::JointType type : solver.jointTypes()) {
    units.emplace_back(type == chain_dynamics::JointType::kPrismatic ? "N" : "N m");
  }
  return units;
}

}  // namespace inverse_dynamics_ros
