// SPDX-License-Identifier: Apache-2.0
#include "parameter_watch.hpp"

#include <chrono>
#include <exception>
#include <utility>

namespace inverse_dynamics_controllers {
namespace {

using rclcpp::node_interfaces::NodeParametersInterface;
using Function = std::function<void(const ParameterValues&)>;

rcl_interfaces::msg::SetParametersResult checked(const std::vector<rclcpp::Parameter>& wanted,
                                                 ParameterValues values, const Function& check) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  bool concerned = false;
  for (const rclcpp::Parameter& parameter : wanted) {
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

}  // namespace

ParameterValues valuesOf(NodeParametersInterface& node, const std::vector<std::string>& names) {
  ParameterValues values;
  for (const std::string& name : names) {
    values[name] = node.get_parameter(name).get_parameter_value();
  }
  return values;
}

ParameterWatch::ParameterWatch(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                               const std::vector<std::string>& names, Function check,
                               Function apply) {
  // The interface, not the node: the node keeps what is made here, and must not be kept by it.
  const std::weak_ptr<NodeParametersInterface> parameters = node->get_node_parameters_interface();
  checking_ = node->add_on_set_parameters_callback(
      [parameters, names, check = std::move(check)](const std::vector<rclcpp::Parameter>& wanted) {
        const auto interface = parameters.lock();
        return checked(wanted, interface ? valuesOf(*interface, names) : ParameterValues(), check);
      });
  // A change that passes this check may be refused by another one, and humble has no callback after
  // all of them.
  const auto last = std::make_shared<ParameterValues>(valuesOf(*parameters.lock(), names));
  polling_ = node->create_wall_timer(std::chrono::milliseconds(50),
                                     [parameters, names, last, apply = std::move(apply)] {
                                       const auto interface = parameters.lock();
                                       if (interface == nullptr) return;
                                       ParameterValues now = valuesOf(*interface, names);
                                       if (now == *last) return;
                                       *last = std::move(now);
                                       apply(*last);
                                     });
}

}  // namespace inverse_dynamics_controllers
