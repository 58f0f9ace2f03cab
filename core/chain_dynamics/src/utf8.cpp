// SPDX-License-Identifier: Apache-2.0

#include "utf8.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace chain_dynamics {
inline namespace v2 {

Character characterAt(const std::string& text, std::size_t i) {
  const unsigned char first = byteAt(text, i);
  if (first < 0x80U) return {first, 1};
  // a leading byte 110....., 1110...., 11110... says how many follow
  const std::size_t size = first >= 0xF0U ? 4 : first >= 0xE0U ? 3 : 2;
  if (first < 0xC2U || first > 0xF4U || i + size > text.size()) return {};
  std::uint32_t code = first & (0xFFU >> (size + 1));
  for (std::size_t k = i + 1; k < i + size; ++k) {
    if (!isContinuation(byteAt(text, k))) return {};
    code = code << 6U | (byteAt(text, k) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  const bool valid = code >= kLeast[size] && code <= 0x10FFFF && !surrogate;
  return valid ? Character{code, size} : Character{};
}

}  // namespace v2
}  // namespace chain_dynamics
