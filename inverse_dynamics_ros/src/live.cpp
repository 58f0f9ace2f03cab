// SPDX-License-Identifier: Apache-2.0

/// @file
/// Program: the node of live_node.hpp by itself.
///
///     ros2 run inverse_dynamics_ros live --ros-args -p plugin_name:=package/Class
///
/// Exit code 0: shut down; 2: something the user can repair (the last line says what).

#include <rclcpp/rclcpp.hpp>

#include "inverse_dynamics_ros/live_node.hpp"
#include "user_error.hpp"

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  inverse_dynamics_ros::ExitCode code = inverse_dynamics_ros::kExitFine;
  try {
    rclcpp::spin(std::make_shared<inverse_dynamics_ros::LiveNode>(rclcpp::NodeOptions()));
  } catch (const std::exception& error) {
    const inverse_dynamics_ros::Failure failure = inverse_dynamics_ros::failureOf(error);
    RCLCPP_FATAL(rclcpp::get_logger("live"), "%s", failure.text.c_str());
    code = failure.code;
  }
  rclcpp::shutdown();
  return code;
}
