// SPDX-License-Identifier: Apache-2.0

#include "node_solver.hpp"

#include <inverse_dynamics_ros/robot_parameters.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rclcpp/parameter.hpp>
#include <string>

namespace inverse_dynamics_ros {

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

inverse_dynamics_solver::Parameters givenParameters(rclcpp::Node& node, const std::string& prefix) {
  inverse_dynamics_evaluation::SolverParameters given;
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  for (const auto& [name, value] : overrides) {
    if (name.rfind(prefix, 0) != 0) continue;
    const auto found =
        inverse_dynamics_solver::detail::valueOf(name, rclcpp::Parameter(name, value));
    if (found) given.emplace(name.substr(prefix.size()), *found);
  }
  return given;
}

}  // namespace inverse_dynamics_ros
