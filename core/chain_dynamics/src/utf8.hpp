// SPDX-License-Identifier: Apache-2.0

/// @file
/// Characters of texts in UTF-8.

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace chain_dynamics {
inline namespace v2 {

struct Character {
  std::uint32_t code = 0;  ///< of Unicode
  std::size_t size = 0;    ///< bytes; 0: no UTF-8
};

inline unsigned char byteAt(const std::string& text, std::size_t i) {
  return static_cast<unsigned char>(text[i]);
}

/// Whether a byte belongs to the character before it.
inline bool isContinuation(unsigned char byte) { return (byte & 0xC0U) == 0x80U; }

/// The character that starts at byte i [RFC 3629].
Character characterAt(const std::string& text, std::size_t i);

}  // namespace v2
}  // namespace chain_dynamics
