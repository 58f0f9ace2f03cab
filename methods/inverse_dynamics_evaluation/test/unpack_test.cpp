// SPDX-License-Identifier: Apache-2.0

#include "unpack.hpp"

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "crc32.hpp"
#include "error_of.hpp"

namespace inverse_dynamics_evaluation::unpack_test {

Bytes bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

Bytes zstdOf(const Bytes& raw) {
  Bytes packed(ZSTD_compressBound(raw.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 3));
  return packed;
}

Bytes lz4Of(const Bytes& raw) {
  Bytes packed(LZ4F_compressFrameBound(raw.size(), nullptr));
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), raw.data(), raw.size(), nullptr));
  return packed;
}

Bytes unpacked(const Bytes& packed) {
  Bytes out;
  ZstdUnpacker().unpack(packed.data(), packed.size(), "a message or chunk", out);
  return out;
}

Bytes unpackedLz4(const Bytes& packed) {
  Bytes out;
  unpackLz4(packed.data(), packed.size(), out);
  return out;
}

Bytes numbers(std::size_t size) {
  Bytes raw(size);
  for (std::size_t i = 0; i < size; ++i) raw[i] = static_cast<std::uint8_t>(i * i >> 7U);
  return raw;
}

TEST(Unpack, GivesBackWhatWasCompressed) {
  for (const std::size_t size : {0U, 1U, 1000U, 5'000'000U}) {
    const Bytes raw = numbers(size);
    EXPECT_EQ(unpacked(zstdOf(raw)), raw);
    EXPECT_EQ(unpackedLz4(lz4Of(raw)), raw);
  }
}

TEST(Unpack, RefusesWhatIsCutOffOrNoise) {
  for (const Bytes& whole : {zstdOf(numbers(1000)), lz4Of(numbers(1000))}) {
    const bool is_lz4 = whole[0] == 0x04;
    for (std::size_t size = 1; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + size);
      EXPECT_THROW(is_lz4 ? unpackedLz4(cut) : unpacked(cut), DamageError) << size;
    }
  }
  EXPECT_THROW(unpacked(numbers(100)), DamageError);
  EXPECT_THROW(unpackedLz4(numbers(100)), DamageError);
}

TEST(Crc32, HasThePublishedCheckValue) {
  const Bytes digits = bytesOf("123456789");  // of CRC-32/ISO-HDLC
  EXPECT_EQ(crc32(digits.data(), digits.size()), 0xcbf43926U);
  EXPECT_EQ(crc32(nullptr, 0), 0U);
}

}  // namespace inverse_dynamics_evaluation::unpack_test
