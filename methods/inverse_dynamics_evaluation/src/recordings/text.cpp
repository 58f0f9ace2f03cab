// SPDX-License-Identifier: Apache-2.0

#include "text.hpp"

#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

std::string counted(std::int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 60;
  return "'" + chain_dynamics::printable(text, kLongest) + "'";
}

void requireUtf8(const std::string& text, const char* what) {
  if (chain_dynamics::firstNotUtf8(text) < text.size()) {
    throw DamageError(std::string(what) + ": expected UTF-8, got " + quoted(text));
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
