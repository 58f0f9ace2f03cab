// SPDX-License-Identifier: Apache-2.0
/// @file
/// The checksum of MCAP's chunks: CRC-32 as in zlib (reflected polynomial 0xedb88320).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// CRC-32 of bytes, eight at a time ["slicing by 8"].
inline std::uint32_t crc32(const std::uint8_t* data, std::size_t size) {
  using Tables = std::array<std::array<std::uint32_t, 256>, 8>;
  static const Tables kTables = [] {
    Tables tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint32_t rest = byte;
      for (int bit = 0; bit < 8; ++bit) rest = rest >> 1U ^ (rest & 1U ? 0xedb88320U : 0U);
      tables[0][byte] = rest;
    }
    for (std::size_t t = 1; t < tables.size(); ++t) {
      for (std::size_t byte = 0; byte < 256; ++byte) {
        const std::uint32_t before = tables[t - 1][byte];
        tables[t][byte] = before >> 8U ^ tables[0][before & 0xffU];
      }
    }
    return tables;
  }();
  std::uint32_t rest = 0xffffffffU;
  for (; size >= 8; size -= 8, data += 8) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      next ^= kTables[7 - i][data[i] ^ (rest >> (8 * i) & 0xffU)] ^ kTables[3 - i][data[4 + i]];
    }
    rest = next;
  }
  for (; size > 0; --size, ++data) rest = rest >> 8U ^ kTables[0][(rest ^ *data) & 0xffU];
  return ~rest;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
