// SPDX-License-Identifier: Apache-2.0
#include "robot_description.hpp"

#include <chrono>
#include <rclcpp/wait_for_message.hpp>
#include <std_msgs/msg/string.hpp>

namespace inverse_dynamics_controllers {

std::string findRobotDescription(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                                 const std::string& parameter, const std::string& managers,
                                 double timeout) {
  if (!parameter.empty()) return parameter;
  if (!managers.empty()) return managers;
  if (timeout <= 0) return "";

  // Waited for here: no executor may take the message.
  rclcpp::SubscriptionOptions options;
  options.callback_group =
      node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, false);
  const auto subscription = node->create_subscription<std_msgs::msg::String>(
      "robot_description", rclcpp::QoS(1).transient_local(),
      [](std_msgs::msg::String::ConstSharedPtr) {}, options);
  std_msgs::msg::String description;
  const auto context = node->get_node_base_interface()->get_context();
  const auto patience = std::chrono::duration<double, std::milli>(1000.0 * timeout);
  if (rclcpp::wait_for_message<std_msgs::msg::String>(
          description, subscription, context,
          std::chrono::duration_cast<std::chrono::milliseconds>(patience))) {
    return description.data;
  }
  RCLCPP_WARN(node->get_logger(),
              "no robot description: nothing came on %s within %g s; go on without, with what the "
              "solver itself knows",
              subscription->get_topic_name(), timeout);
  return "";
}

}  // namespace inverse_dynamics_controllers
