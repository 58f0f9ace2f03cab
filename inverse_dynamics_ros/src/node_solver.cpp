// SPDX-License-Identifier: Apache-2.0

#include "node_solver.hpp"

#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <set>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::listed;
using inverse_dynamics_solver::InverseDynamicsSolver;

}  // namespace

void declareSolverParameters(rclcpp::Node& node) {
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  for (const auto& [name, value] : overrides) {
    if (name.rfind(kSolverNamespace + ".", 0) != 0) {
      continue;
    }
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.read_only = true;
    descriptor.dynamic_typing = true;  // the solver checks types
    node.declare_parameter(name, value, descriptor);
  }
}

std::shared_ptr<const InverseDynamicsSolver> makeSolver(rclcpp::Node& node,
                                                        const std::string& plugin_name,
                                                        const std::string& robot_description) {
  const inverse_dynamics_solver::SolverLoader loader;
  if (plugin_name.empty()) {
    throw UserError("parameter 'plugin_name'", "a solver, package/Class", "nothing",
                    "set it to one of " + listed(loader.availableSolvers()));
  }
  const auto solver = loader.load(plugin_name);
  inverse_dynamics_solver::initializeStrictly(*solver, node.get_node_parameters_interface(),
                                              kSolverNamespace, robot_description);
  return solver;
}

std::vector<std::string> torqueUnits(rclcpp::Node& node,
                                     const std::vector<std::string>& joint_names,
                                     const std::string& robot_description) {
  std::set<std::string> prismatic;
  if (!robot_description.empty()) {
    try {
      const auto chain =
          inverse_dynamics_solver::chainFromDescription(inverse_dynamics_solver::readConfiguration(
              node.get_node_parameters_interface(), kSolverNamespace, robot_description));
      for (const chain_dynamics::Joint& joint : chain.joints()) {
        if (joint.type == chain_dynamics::JointType::kPrismatic) {
          prismatic.insert(joint.name);
        }
      }
    } catch (const inverse_dynamics_solver::Exception&) {
      // a solver with its own model takes no notice of the description either
    }
  }
  std::vector<std::string> units;
  units.reserve(joint_names.size());
  for (const std::string& name : joint_names) {
    units.emplace_back(prismatic.count(name) > 0 ? "N" : "N m");
  }
  return units;
}

std::vector<std::string> messageNames(const std::vector<std::string>& given,
                                      const std::vector<std::string>& joint_names) {
  if (given.empty()) {
    return joint_names;
  }
  if (given.size() != joint_names.size()) {
    throw UserError("parameter 'joints'",
                    std::to_string(joint_names.size()) + " names, one per joint of the chain (" +
                        listed(joint_names) + ")",
                    std::to_string(given.size()) + " (" + listed(given) + ")", "correct them");
  }
  const bool same_set = std::set<std::string>(given.begin(), given.end()) ==
                        std::set<std::string>(joint_names.begin(), joint_names.end());
  if (same_set && given != joint_names) {
    throw UserError("parameter 'joints'", "the order of the chain, " + listed(joint_names),
                    listed(given), "the order in the messages doesn't matter, so leave it out");
  }
  return given;
}

inverse_dynamics_evaluation::EffortOptions effortOptions(const std::string& effort,
                                                         const std::vector<double>& drive_gains,
                                                         const std::string& plugin_name,
                                                         const InverseDynamicsSolver& solver) {
  inverse_dynamics_evaluation::EffortOptions options;
  options.configuration = effort;
  options.where = "parameter 'effort'";
  options.gains_from = "parameter 'drive_gains'";
  options.plugin = plugin_name;
  options.configured_by = "the node's configuration";
  options.drive_gains =
      inverse_dynamics_evaluation::driveGains(drive_gains, options.gains_from, solver);
  return options;
}

}  // namespace inverse_dynamics_ros
