// SPDX-License-Identifier: Apache-2.0

/// @file
/// The one exception of this package: a robot that can't be, or can't be read.
///
///     throw ModelError("arm.yaml:31: joint elbow", "friction", "5 numbers", "4 numbers",
///                      "give fv, fo, fc, alpha, nu");
///     // arm.yaml:31: joint elbow: friction: expected 5 numbers, got 4 numbers; give fv, ...

#pragma once

#include <stdexcept>
#include <string>

#include "chain_dynamics/text.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A user's mistake in a robot description, model file or argument.
///
/// The text says where, what, what was expected, what was found, and the remedy; it is printable()
/// [text.hpp]. Mistakes of developers (a vector of the wrong size) are assertions of debug builds
/// instead.
class ModelError : public std::runtime_error {
 public:
  /// A text as it is, of up to 8000 bytes.
  explicit ModelError(const std::string& text) : std::runtime_error(printable(text, 8000)) {}

  /// Text `where: what: expected ..., got ...; remedy`. Empty parts are left out.
  ModelError(const std::string& where, const std::string& what, const std::string& expected,
             const std::string& got, const std::string& remedy)
      : std::runtime_error(errorText(where, what, expected, got, remedy)) {}
};

}  // namespace v2
}  // namespace chain_dynamics
