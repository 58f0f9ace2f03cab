// SPDX-License-Identifier: Apache-2.0
/// @file
/// Rejects misspelt parameters of a node, which would silently leave the default.
///
///     const auto parameters = node->get_node_parameters_interface();
///     rejectUndeclared(*parameters);
///     solver->initialize(Parameters(parameters).strict(), "ids", urdf);
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace detail {

/// True from jazzy on.
template <class T, class = void>
struct HasCallbackBeforeSetting : std::false_type {};
template <class T>
struct HasCallbackBeforeSetting<
    T, std::void_t<decltype(std::declval<T&>().add_pre_set_parameters_callback(nullptr))>>
    : std::true_type {};

}  // namespace detail

/// Rejects parameters that a node doesn't declare.
///
/// `qos_overrides.*` are rclcpp's, which declares them together with the topic that they name.
///
/// @param given     names of parameters that are set.
/// @param declared  names of all that the node declares.
/// Throws InvalidParameterValueException: the first that isn't declared, and the name that is
/// most like it.
void rejectUndeclared(const std::vector<std::string>& given,
                      const std::vector<std::string>& declared);

/// The same, of all parameters that were set from outside: launch file, parameter file, command
/// line.
///
/// @param node  rclcpp's NodeParametersInterface, when the node has declared all that it reads.
template <class Interface>
void rejectUndeclared(const Interface& node) {
  std::vector<std::string> given;
  for (const auto& [name, value] : node.get_parameter_overrides()) given.push_back(name);
  constexpr std::uint64_t kAllDepths = 0;
  rejectUndeclared(given, node.list_parameters({}, kAllDepths).names);
}

/// Makes `ros2 param set` of an undeclared parameter suggest the nearest name; from jazzy on.
///
/// @tparam NotDeclared  rclcpp::exceptions::ParameterNotDeclaredException, which rclcpp expects.
/// @param node  outlives what is returned; refuses undeclared parameters (the default of
///     rclcpp::NodeOptions).
/// @return for as long as it is kept.
template <class NotDeclared, class Interface>
std::shared_ptr<void> suggestDeclared(Interface& node) {
  if constexpr (detail::HasCallbackBeforeSetting<Interface>::value) {
    return node.add_pre_set_parameters_callback([&node](const auto& parameters) {
      constexpr std::uint64_t kAllDepths = 0;
      const std::vector<std::string> declared = node.list_parameters({}, kAllDepths).names;
      try {
        for (const auto& parameter : parameters) rejectUndeclared({parameter.get_name()}, declared);
      } catch (const InvalidParameterValueException& error) {
        throw NotDeclared(error.what());
      }
    });
  } else {
    return nullptr;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
