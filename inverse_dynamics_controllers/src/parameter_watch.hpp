// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters that may change while a controller runs.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using ParameterValues = std::map<std::string, rclcpp::ParameterValue>;

/// Refuses changes of parameters that don't fit together, and hands on those that were made.
class ParameterWatch {
 public:
  /// @param names  declared parameters of the node.
  /// @param check  throws if the values of all these parameters don't fit; its text is the
  ///   reason of the refusal.
  /// @param apply  called by the node's executor, within 50 ms of a change.
  ParameterWatch(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                 const std::vector<std::string>& names,
                 std::function<void(const ParameterValues&)> check,
                 std::function<void(const ParameterValues&)> apply);

 private:
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr checking_;
  rclcpp::TimerBase::SharedPtr polling_;
};

/// The values of parameters now.
ParameterValues valuesOf(rclcpp::node_interfaces::NodeParametersInterface& node,
                         const std::vector<std::string>& names);

}  // namespace inverse_dynamics_controllers
