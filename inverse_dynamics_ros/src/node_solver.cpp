// SPDX-License-Identifier: Apache-2.0

#include "node_solver.hpp"

#include <algorithm>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <set>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::listed;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Parameters;
using ParametersInterface = rclcpp::node_interfaces::NodeParametersInterface;

/// A node's parameters, noting which ones were asked for.
class NotedParameters {
 public:
  explicit NotedParameters(ParametersInterface::SharedPtr parameters)
      : parameters_(std::move(parameters)) {}

  bool has_parameter(const std::string& name) const {
    asked_.insert(name);
    return parameters_->has_parameter(name);
  }
  rclcpp::Parameter get_parameter(const std::string& name) const {
    return parameters_->get_parameter(name);
  }

  bool wasAsked(const std::string& name) const { return asked_.count(name) > 0; }

  /// Names below the solver's namespace that were asked for.
  std::vector<std::string> asked() const {
    std::vector<std::string> names;
    std::copy_if(asked_.begin(), asked_.end(), std::back_inserter(names),
                 [](const auto& name) { return name.rfind(kSolverNamespace + ".", 0) == 0; });
    return names;
  }

 private:
  ParametersInterface::SharedPtr parameters_;
  mutable std::set<std::string> asked_;
};

// Names below the solver's namespace that the user gave.
std::vector<std::string> givenNames(rclcpp::Node& node) {
  std::vector<std::string> names;
  for (const auto& [name, value] :
       node.get_node_parameters_interface()->get_parameter_overrides()) {
    if (name.rfind(kSolverNamespace + ".", 0) == 0) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

void declareSolverParameters(rclcpp::Node& node) {
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  for (const std::string& name : givenNames(node)) {
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.read_only = true;
    descriptor.dynamic_typing = true;  // the solver checks types
    node.declare_parameter(name, overrides.at(name), descriptor);
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
  const auto parameters = std::make_shared<NotedParameters>(node.get_node_parameters_interface());
  solver->initialize(Parameters(parameters), kSolverNamespace, robot_description);
  for (const std::string& name : givenNames(node)) {
    if (!parameters->wasAsked(name)) {
      throw UserError("parameter '" + name + "'", "a parameter that the solver reads",
                      "one that " + plugin_name + " doesn't know",
                      "correct its name; it reads " + listed(parameters->asked()));
    }
  }
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

}  // namespace inverse_dynamics_ros
