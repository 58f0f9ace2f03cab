// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where a controller gets the robot description from.
#pragma once

#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/string.hpp>
#include <string>

namespace inverse_dynamics_controllers {

/// Listens to the topic `robot_description` (kept for late joiners, as robot_state_publisher does
/// it) from its construction on. Threads: safe.
class RobotDescriptionTopic {
 public:
  explicit RobotDescriptionTopic(std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node);

  /// URDF text: the parameter's, the controller manager's, or the newest that has come on the
  /// topic. Empty: none of them; a warning says so. Where the topic has a publisher, it waits 2 s
  /// for the first message; for nothing else.
  ///
  /// @param parameter  value of the parameter `robot_description`.
  /// @param managers   what the controller manager has given.
  std::string find(const std::string& parameter, const std::string& managers) const;

 private:
  struct Inbox;

  std::string takeNewest() const;

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_;
  std::shared_ptr<Inbox> inbox_;  // a message that is being received keeps it
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr subscription_;
};

}  // namespace inverse_dynamics_controllers
