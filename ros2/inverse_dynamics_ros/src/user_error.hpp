// SPDX-License-Identifier: Apache-2.0

/// @file
/// A mistake a user can repair, and the exit codes of this package's programs.

#pragma once

#include <exception>
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
