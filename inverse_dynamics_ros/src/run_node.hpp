// SPDX-License-Identifier: Apache-2.0

/// @file
/// A program that is one node.

#pragma once

#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "user_error.hpp"

namespace inverse_dynamics_ros {

/// @return exit code. 0: shut down; 2: something the user can repair (the last line says what).
template <class Node>
int runNode(int argc, char** argv, const char* name) {
  rclcpp::init(argc, argv);
  ExitCode code = kExitFine;
  try {
    rclcpp::spin(std::make_shared<Node>(rclcpp::NodeOptions()));
  } catch (const std::exception& error) {
    const Failure failure = failureOf(error);
    RCLCPP_FATAL(rclcpp::get_logger(name), "%s", failure.text.c_str());
    code = failure.code;
  }
  rclcpp::shutdown();
  return code;
}

}  // namespace inverse_dynamics_ros
