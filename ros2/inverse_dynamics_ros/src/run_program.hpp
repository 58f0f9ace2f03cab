// SPDX-License-Identifier: Apache-2.0

/// @file
/// The main function of this package's programs.

#pragma once

#include <exception>
#include <rclcpp/rclcpp.hpp>

#include "user_error.hpp"

namespace inverse_dynamics_ros {

/// Does the work between rclcpp's start and end.
///
/// @return exit code. 0: done, or shut down; 2: something the user can repair (the last line says
///     what); 130: interrupted.
template <class Work>
int runProgram(int argc, char** argv, const char* name, const Work& work) {
  ExitCode code = kExitFine;
  bool initialized = false;
  try {
    rclcpp::init(argc, argv);
    initialized = true;
    work();
  } catch (const std::exception& error) {
    const Failure failure = initialized && !rclcpp::ok()
                                ? Failure{kExitInterrupted, Interrupted().what()}
                                : failureOf(error);
    RCLCPP_FATAL(rclcpp::get_logger(name), "%s", failure.text.c_str());
    code = failure.code;
  }
  rclcpp::shutdown();
  return code;
}

}  // namespace inverse_dynamics_ros
