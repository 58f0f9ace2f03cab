// SPDX-License-Identifier: Apache-2.0

/// @file
/// Program: the node of live_node.hpp by itself.
///
///     ros2 run inverse_dynamics_ros live --ros-args -p plugin_name:=package/Class

#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "inverse_dynamics_ros/live_node.hpp"
#include "run_program.hpp"

int main(int argc, char** argv) {
  return inverse_dynamics_ros::runProgram(argc, argv, "live", [] {
    rclcpp::spin(std::make_shared<inverse_dynamics_ros::LiveNode>(rclcpp::NodeOptions()));
  });
}
