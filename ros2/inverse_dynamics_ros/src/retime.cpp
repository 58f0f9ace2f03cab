// SPDX-License-Identifier: Apache-2.0

/// @file
/// Program: the node of retime_node.hpp by itself.
///
///     ros2 run inverse_dynamics_ros retime --ros-args -p plugin_name:=package/Class

#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "retime_node.hpp"
#include "run_program.hpp"

int main(int argc, char** argv) {
  return inverse_dynamics_ros::runProgram(argc, argv, "retime", [] {
    rclcpp::spin(std::make_shared<inverse_dynamics_ros::RetimeNode>(rclcpp::NodeOptions()));
  });
}
