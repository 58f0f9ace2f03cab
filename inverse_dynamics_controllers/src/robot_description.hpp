// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where a controller gets the robot description from.
#pragma once

#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>

namespace inverse_dynamics_controllers {

/// URDF text: the parameter's, the controller manager's, or the first that comes on the topic
/// `robot_description` (kept for late joiners, as robot_state_publisher does it). Empty: none of
/// them; a warning says so.
///
/// @param parameter  value of the parameter `robot_description`.
/// @param managers   what the controller manager has given.
/// @param timeout    how long to wait for the topic [s].
std::string findRobotDescription(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                                 const std::string& parameter, const std::string& managers,
                                 double timeout);

}  // namespace inverse_dynamics_controllers
