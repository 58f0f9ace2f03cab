// SPDX-License-Identifier: Apache-2.0

#include "unpack.hpp"

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zstd.h>

#include <cstdlib>
#include <string>

#include "crc32.hpp"
#include "error_of.hpp"

namespace inverse_dynamics_evaluation::unpack_test {

using ::testing::HasSubstr;

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

// Sets the variable for the time of a test.
struct Limit {
  explicit Limit(const char* megabytes) { setenv("IDS_UNPACK_LIMIT_MB", megabytes, 1); }
  ~Limit() { unsetenv("IDS_UNPACK_LIMIT_MB"); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;
};

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

TEST(Unpack, ReadsFramesOneAfterAnother) {
  Bytes two = zstdOf(bytesOf("small"));
  const Bytes second = zstdOf(numbers(100'000));
  two.insert(two.end(), second.begin(), second.end());
  EXPECT_EQ(unpacked(two).size(), 100'005U);
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

TEST(Unpack, StopsAtTheLimit) {
  const Limit limit("1");
  const Bytes bomb(2'000'000);
  for (const auto& what : {errorOf<ReadingError>([&] { unpacked(zstdOf(bomb)); }),
                           errorOf<ReadingError>([&] { unpackedLz4(lz4Of(bomb)); })}) {
    EXPECT_THAT(what, HasSubstr("bytes unpacks to more than 1 MB: it is damaged, or made to fill "
                                "memory or disk; if you trust it, raise the limit with "
                                "IDS_UNPACK_LIMIT_MB"));
  }
  const Bytes raw = numbers(1'000'000);
  EXPECT_EQ(unpacked(zstdOf(raw)), raw);
}

TEST(Unpack, LimitIsAWholeNumberOfMegabytes) {
  EXPECT_EQ(mostUnpacked(1), 256'000'000U);
  EXPECT_EQ(mostUnpacked(100'000'000), 5'000'000'000U);
  for (const char* text : {"-1", "1.5", "many", "\xd9\xa3", "9999999999999"}) {
    const Limit limit(text);
    EXPECT_THAT(errorOf<ReadingError>([] { mostUnpacked(1); }),
                HasSubstr("IDS_UNPACK_LIMIT_MB: expected a whole number of megabytes, got '"));
  }
}

TEST(Crc32, HasThePublishedCheckValue) {
  const Bytes digits = bytesOf("123456789");  // of CRC-32/ISO-HDLC
  EXPECT_EQ(crc32(digits.data(), digits.size()), 0xcbf43926U);
  EXPECT_EQ(crc32(nullptr, 0), 0U);
}

}  // namespace inverse_dynamics_evaluation::unpack_test
