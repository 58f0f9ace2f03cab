// SPDX-License-Identifier: Apache-2.0
/// @file
/// Exceptions of the interface and its solvers: one family, one class per reaction of a caller.
///
///     try {
///       solver->initialize(parameters, "ids");
///     } catch (const inverse_dynamics_solver::InvalidParameterValueException& e) {
///       ask_user(e.what());
///     } catch (const inverse_dynamics_solver::Exception& e) {
///       give_up(e.what());
///     }
#pragma once

#include <stdexcept>
#include <string>

#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Text of every error: `where: what: expected ..., got ...; remedy`.
using chain_dynamics::errorText;

/// Root of the family. Reaction: report `what()`, use another solver or none.
class Exception : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// The text is that of errorText().
  Exception(const std::string& where, const std::string& what, const std::string& expected = "",
            const std::string& got = "", const std::string& remedy = "")
      : std::runtime_error(errorText(where, what, expected, got, remedy)) {}
};

/// A method was called before a successful initialize(). Reaction: initialize.
class UninitializedException : public Exception {
 public:
  /// @param method  the method that was called too early.
  explicit UninitializedException(const std::string& method = "solver")
      : Exception(method, "the solver is not initialized", "", "",
                  "call initialize() first, and see that it doesn't throw") {}
};

/// A parameter without a default is missing. Reaction: set it.
class ParameterUninitializedException : public Exception {
 public:
  using Exception::Exception;
};

/// A parameter is there, but of the wrong type, length or value. Reaction: correct it.
class InvalidParameterValueException : public Exception {
 public:
  using Exception::Exception;
};

/// The robot description isn't usable: not a URDF, no such link, no chain. Reaction: correct it.
class InvalidRobotDescriptionException : public InvalidParameterValueException {
 public:
  using InvalidParameterValueException::InvalidParameterValueException;
};

/// A vector or matrix has the wrong size. Reaction: one number per joint, in the order of
/// jointNames().
class SizeMismatchException : public Exception {
 public:
  using Exception::Exception;
};

/// No usable plugin of that name. Reaction: correct the name, or source the workspace that has it.
class PluginNotFoundException : public Exception {
 public:
  using Exception::Exception;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
