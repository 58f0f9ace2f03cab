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

/// What a program ends with; the same codes as the command line's.
enum ExitCode {
  kExitFine = 0,
  kExitUnexpected = 1,
  kExitUserError = 2,
  kExitInterrupted = 130,
};

/// Exit code and text for whatever a node's set-up or work threw.
struct Failure {
  ExitCode code;
  std::string text;
};

/// Tells users' mistakes (of parameters, recordings, solvers) from everything else.
Failure failureOf(const std::exception& error);

}  // namespace inverse_dynamics_ros
