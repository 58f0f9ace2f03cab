// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters of a node of ROS that may change while a loop runs.
///
/// A template that takes the types of ROS from the node: no header of ROS is needed here.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {

/// Refuses changes of parameters that don't fit together, and hands on those that were made.
///
/// @tparam Node  rclcpp::Node or rclcpp_lifecycle::LifecycleNode.
template <class Node>
class ParameterWatch {
 public:
  using Interface = std::decay_t<decltype(*std::declval<Node&>().get_node_parameters_interface())>;
  using Parameter = decltype(std::declval<Interface&>().get_parameter(std::string()));
  using Parameters = std::vector<Parameter>;
  using Result = decltype(std::declval<Interface&>().set_parameters_atomically(Parameters()));
  using Value = std::decay_t<decltype(std::declval<Parameter&>().get_parameter_value())>;
  using Values = std::map<std::string, Value>;
  using Function = std::function<void(const Values&)>;

  /// @param names  declared parameters of the node.
  /// @param check  throws if the values of all these parameters don't fit; its text is the reason of
  ///     the refusal.
  /// @param apply  called after a change; in humble by the node's executor, within 50 ms.
  ParameterWatch(Node& node, const std::vector<std::string>& names, Function check,
                 Function apply) {
    // The interface, not the node: the node keeps what is made here, and must not be kept by it.
    const std::weak_ptr<Interface> parameters = node.get_node_parameters_interface();
    checking_ = node.add_on_set_parameters_callback(
        [parameters, names, check = std::move(check)](const Parameters& wanted) {
          const auto interface = parameters.lock();
          return checked(wanted, interface ? valuesOf(*interface, names) : Values(), check);
        });
    // A change that passes this check may be refused by another one.
    const auto last = std::make_shared<Values>(valuesOf(*parameters.lock(), names));
    following_ = afterChanges(
        node,
        [parameters, names, last, apply = std::move(apply)] {
          const auto interface = parameters.lock();
          if (interface == nullptr) return;
          Values now = valuesOf(*interface, names);
          if (now == *last) return;
          *last = std::move(now);
          apply(*last);
        },
        0);
  }

  /// Values of declared parameters, by name.
  static Values valuesOf(const Interface& node, const std::vector<std::string>& names) {
    Values values;
    for (const std::string& name : names) {
      values[name] = node.get_parameter(name).get_parameter_value();
    }
    return values;
  }

 private:
  static Result checked(const Parameters& wanted, Values values, const Function& check) {
    Result result;
    result.successful = true;
    bool concerned = false;
    for (const Parameter& parameter : wanted) {
      const auto watched = values.find(parameter.get_name());
      if (watched == values.end()) continue;
      watched->second = parameter.get_parameter_value();
      concerned = true;
    }
    try {
      if (concerned) check(values);
    } catch (const std::exception& error) {
      result.successful = false;
      result.reason = error.what();
    }
    return result;
  }

  template <class N>
  static auto afterChanges(N& node, const std::function<void()>& call, int)
      -> decltype(node.add_post_set_parameters_callback(std::function<void(const Parameters&)>())) {
    return node.add_post_set_parameters_callback([call](const Parameters&) { call(); });
  }
  // Humble has no callback after a change.
  template <class N>
  static std::shared_ptr<void> afterChanges(N& node, const std::function<void()>& call, long) {
    return node.create_wall_timer(std::chrono::milliseconds(50), call);
  }

  std::shared_ptr<void> checking_, following_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
