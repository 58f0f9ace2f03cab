// SPDX-License-Identifier: Apache-2.0
/// @file
/// What is wrong with a file, and words for it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Damage: the reason alone; Recording adds the path and the remedy.
class DamageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A reason why a file that may be intact can't be read, and the remedy: the text lacks the path only.
class ReadingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// `1 message`, `6 messages`.
std::string counted(std::int64_t count, const std::string& noun);

/// The beginning of a text, in quotes, printable.
std::string quoted(const std::string& text);

/// @throws DamageError: the text isn't UTF-8; what: what it is.
void requireUtf8(const std::string& text, const char* what);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
