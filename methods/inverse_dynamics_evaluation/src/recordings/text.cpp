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

bool isUtf8(const char* text, std::size_t size) {
  const auto* byte = reinterpret_cast<const unsigned char*>(text);
  const unsigned char* const end = byte + size;
  while (byte < end) {
    const unsigned first = *byte++;
    if (first < 0x80) continue;
    const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    if (first < 0xc2 || first > 0xf4 || end - byte < more) return false;
    // The second byte excludes overlong forms, surrogates and what lies beyond U+10FFFF.
    const unsigned least = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned most = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    if (*byte < least || *byte > most) return false;
    for (int i = 1; i < more; ++i) {
      if ((byte[i] & 0xc0U) != 0x80U) return false;
    }
    byte += more;
  }
  return true;
}

void requireUtf8(const std::string& text, const char* what) {
  if (!isUtf8(text.data(), text.size())) {
    throw DamageError(std::string(what) + ": expected UTF-8, got " + quoted(text));
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
