// SPDX-License-Identifier: Apache-2.0

/// @file
/// Why programs of this package end without a result: a mistake a user can repair, or Ctrl-C; and
/// their exit codes.

#pragma once

#include <exception>
#include <rclcpp/utilities.hpp>
#include <stdexcept>
#include <string>

namespace inverse_dynamics_ros {

/// The text says where, what was expected, what was found, and the remedy.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  UserError(const std::string& where, const std::string& expected, const std::string& got,
            const std::string& remedy)
      : std::runtime_error(where + ": expected " + expected + ", got " + got + "; " + remedy) {}
};

/// The user wants the program to end.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted; nothing was written"; }
};

/// @throws Interrupted: rclcpp was shut down, by Ctrl-C for one.
inline void requireNoInterrupt() {
  if (!rclcpp::ok()) throw Interrupted();
}

/// Exit codes of the programs; the same as the command line's.
enum ExitCode {
  kExitFine = 0,
  kExitUnexpected = 1,
  kExitUserError = 2,
  kExitInterrupted = 130,
};

/// Exit code and text of an exception.
struct Failure {
  ExitCode code;
  std::string text;
};

/// Distinguishes users' mistakes (parameters, recordings, solvers) from other exceptions.
Failure failureOf(const std::exception& error);

}  // namespace inverse_dynamics_ros
