// SPDX-License-Identifier: Apache-2.0

/// @file
/// Work that ends, with nothing written, when the user presses Ctrl-C.

#pragma once

#include <exception>
#include <rclcpp/utilities.hpp>

namespace inverse_dynamics_ros {

/// The user wants the program to end.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted; nothing was written"; }
};

/// @throws Interrupted: rclcpp was shut down, by Ctrl-C for one.
inline void requireNoInterrupt() {
  if (!rclcpp::ok()) throw Interrupted();
}

}  // namespace inverse_dynamics_ros
