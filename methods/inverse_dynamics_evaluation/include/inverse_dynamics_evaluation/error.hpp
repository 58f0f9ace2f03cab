// SPDX-License-Identifier: Apache-2.0

/// @file
/// The exceptions of this package: samples that can't be evaluated, recordings and run configurations
/// that can't be used.
///
///     throw EvaluationError("metrics", "samples", "3 columns", "2 columns", "pair each computed "
///                           "sample with its measured one");
///     // metrics: samples: expected 3 columns, got 2 columns; pair each computed sample with ...

#pragma once

#include <stdexcept>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A mistake in the arguments: sizes, too few samples, numbers that aren't finite, wrong stamps.
///
/// The text says where, what, what was expected, what was found, and the remedy.
class EvaluationError : public std::invalid_argument {
 public:
  /// Text `where: what: expected ..., got ...; remedy`.
  EvaluationError(const std::string& where, const std::string& what, const std::string& expected,
                  const std::string& got, const std::string& remedy)
      : std::invalid_argument(where + ": " + what + ": expected " + expected + ", got " + got +
                              "; " + remedy) {}

  /// That text.
  explicit EvaluationError(const std::string& text) : std::invalid_argument(text) {}
};

/// A run configuration that doesn't say what is asked of it.
///
/// The text says where, what was expected, what was found, and the remedy.
class ConfigurationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A recording that can't be read or doesn't hold what is asked of it.
///
/// The text says where, what was expected, what was found, and the remedy.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
