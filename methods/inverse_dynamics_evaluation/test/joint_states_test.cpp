// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "error_of.hpp"
#include "joint_state_block.hpp"
#include "joint_state_decoder.hpp"
#include "joint_state_encoder.hpp"

namespace inverse_dynamics_evaluation::joint_states_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Strings = std::vector<std::string>;

// Joints "a" and "bcd", frame "xyzw", 1.5 s, position 1 and 2, no velocity, effort -1 and 0.5:
// worked out by hand from the rules of CDR.
// clang-format off
const Bytes kMessage = {
    0, 1, 0, 0,                                                  // encapsulation
    1, 0, 0, 0, 0, 0x65, 0xcd, 0x1d,                             // 1 s, 500000000 ns
    5, 0, 0, 0, 'x', 'y', 'z', 'w', 0, 0, 0, 0,                  // frame, padding
    2, 0, 0, 0,                                                  // two names
    2, 0, 0, 0, 'a', 0, 0, 0,                                    // name, padding
    4, 0, 0, 0, 'b', 'c', 'd', 0,                                // name
    2, 0, 0, 0, 0, 0, 0, 0,                                      // two positions, padding
    0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40,     // 1, 2
    0, 0, 0, 0,                                                  // no velocity
    2, 0, 0, 0,                                                  // two efforts
    0, 0, 0, 0, 0, 0, 0xf0, 0xbf, 0, 0, 0, 0, 0, 0, 0xe0, 0x3f,  // -1, 0.5
};
// clang-format on
const std::size_t kPositions = 52, kEfforts = 76;
const std::initializer_list<std::size_t> kLengths = {12, 24, 28, 36, 44, 68, 72};

JointStateBlock blockOf(const std::vector<Bytes>& messages) {
  JointStateDecoder decoder;
  JointStateBlock block;
  for (const Bytes& message : messages) {
    JointSample sample = decoder.decode(message.data(), message.size());
    sample.receive_stamp = 7;
    block.add(sample);
  }
  return block;
}

Bytes encoded(const Strings& names, std::int64_t stamp, const std::vector<double>& numbers) {
  const std::size_t n = names.size();
  const JointStateEncoder encoder(names, "base", {n, n, n});
  Bytes message(encoder.size());
  encoder.write(stamp, {numbers.data(), numbers.data(), numbers.data()}, message.data());
  return message;
}

// The same message with the most significant byte of each number first.
Bytes bigEndian(Bytes message) {
  const auto reverse = [&](std::size_t at, std::size_t size) {
    std::reverse(message.begin() + at, message.begin() + at + size);
  };
  message[1] = 0;
  for (const std::size_t at : {4, 8}) reverse(at, 4);
  for (const std::size_t at : kLengths) reverse(at, 4);
  for (const std::size_t at : {kPositions, kPositions + 8, kEfforts, kEfforts + 8}) reverse(at, 8);
  return message;
}

void expectMessage(const JointStateBlock& block) {
  EXPECT_EQ(block.joint_names, (Strings{"a", "bcd"}));
  EXPECT_EQ(block.frame_id, "xyzw");
  EXPECT_THAT(block.header_stamps, ElementsAre(1'500'000'000));
  EXPECT_THAT(block.receive_stamps, ElementsAre(7));
  EXPECT_THAT(block.position.values, ElementsAre(1, 2));
  EXPECT_THAT(block.velocity.values, ElementsAre());
  EXPECT_THAT(block.effort.values, ElementsAre(-1, 0.5));
  EXPECT_EQ(block.position.columns, 2U);
  EXPECT_EQ(block.velocity.columns, 0U);
}

TEST(JointStateDecoder, ReadsAMessageWorkedOutByHand) { expectMessage(blockOf({kMessage})); }

TEST(JointStateDecoder, ReadsTheOtherOrderOfBytes) {
  expectMessage(blockOf({bigEndian(kMessage)}));
  EXPECT_EQ(blockOf({kMessage, bigEndian(kMessage), kMessage}).size(), 3U);
}

TEST(JointStateEncoder, WritesAMessageWorkedOutByHand) {
  const JointStateEncoder encoder({"a", "bcd"}, "xyzw", {2, 0, 2});
  Bytes message(encoder.size());
  const double position[] = {1, 2}, effort[] = {-1, 0.5};
  encoder.write(1'500'000'000, {position, nullptr, effort}, message.data());
  EXPECT_EQ(message, kMessage);
}

TEST(JointStateEncoder, KeepsStampsBefore1970) {
  for (const std::int64_t stamp : {-1LL, -1'000'000'000LL, -1'500'000'000LL, 0LL, 999'999'999LL}) {
    EXPECT_THAT(blockOf({encoded({"a"}, stamp, {0})}).header_stamps, ElementsAre(stamp));
  }
}

TEST(JointStateDecoder, TakesMessagesThatDifferInPaddingOnlyForTheSame) {
  Bytes other = kMessage;
  for (const std::size_t padding : {2, 3, 21, 23, 34, 35, 48, 51}) {
    ASSERT_EQ(other[padding], 0);
    other[padding] = 0xee;
  }
  const JointStateBlock block = blockOf({kMessage, other, kMessage});
  EXPECT_THAT(block.position.values, ElementsAre(1, 2, 1, 2, 1, 2));
  EXPECT_THAT(block.effort.values, ElementsAre(-1, 0.5, -1, 0.5, -1, 0.5));
}

TEST(JointStateDecoder, TellsMessagesOfOtherNamesFramesAndLengthsApart) {
  const Bytes others[] = {encoded({"a", "bcd"}, 1, {1, 2}), encoded({"a", "b"}, 1, {1, 2})};
  JointStateDecoder decoder;
  for (const Bytes& other : others) {
    EXPECT_EQ(decoder.decode(kMessage.data(), kMessage.size()).frame_id, "xyzw");
    const JointSample sample = decoder.decode(other.data(), other.size());
    EXPECT_EQ(sample.frame_id, "base");
    EXPECT_EQ(sample.names->size(), 2U);
    EXPECT_EQ(sample.velocity.size, 2U);
  }
}

TEST(JointStateDecoder, RefusesAMessageThatIsCutOffAnywhere) {
  for (const Bytes& message : {kMessage, bigEndian(kMessage)}) {
    for (std::size_t size = 0; size < message.size(); ++size) {
      const Bytes cut(message.begin(), message.begin() + size);  // memory of just that size
      EXPECT_THROW(layoutOf(cut.data(), cut.size()), DamageError) << size;
    }
  }
}

Bytes followed(Bytes message, std::size_t more, std::uint8_t byte = 0xee) {
  message.insert(message.end(), more, byte);
  return message;
}

Bytes changed(Bytes message, std::size_t at, std::uint8_t byte) {
  message[at] = byte;
  return message;
}

TEST(JointStateDecoder, IgnoresWhatFollowsTheLastFieldAndRefusesLengthsBeyondTheEnd) {
  const struct {
    const char* what;
    Bytes message;
    const char* error;  // none: read
  } cases[] = {
      {"nothing", kMessage, ""},
      {"up to a multiple of 4", followed(kMessage, 3), ""},
      {"up to a multiple of 8", followed(kMessage, 4), ""},
      {"as rclpy of jazzy with two empty arrays", followed(kMessage, 8), ""},
      {"zeros", followed(kMessage, 8, 0), ""},
      {"more than the message", followed(kMessage, 1000), ""},
      {"in the other order of bytes", followed(bigEndian(kMessage), 8), ""},
      {"the number of bytes of padding in the encapsulation's options",
       followed(changed(kMessage, 3, 3), 3), ""},
      {"a frame that is too long", changed(followed(kMessage, 8), 12, 85),
       "expected 85 bytes at offset 16, got a message of 100"},
      {"a name that is too long", changed(followed(kMessage, 8), 28, 69),
       "expected 69 bytes at offset 32, got a message of 100"},
      {"too many velocities", changed(followed(kMessage, 8), 68, 4),
       "expected 32 bytes at offset 76, got a message of 100"},
      {"too many efforts", changed(followed(kMessage, 8), 72, 4),
       "expected 32 bytes at offset 76, got a message of 100"},
  };
  for (const auto& [what, message, error] : cases) {
    SCOPED_TRACE(what);
    if (*error == '\0') {
      expectMessage(blockOf({message}));
      EXPECT_THAT(blockOf({message, kMessage, message, message}).effort.values,
                  ElementsAre(-1, 0.5, -1, 0.5, -1, 0.5, -1, 0.5));
    } else {
      EXPECT_THAT(errorOf<DamageError>([&, &text = message] { blockOf({text}); }),
                  HasSubstr(error));
    }
  }
}

TEST(JointStateDecoder, ReadsWhatRclpySerializes) {
  // serialize_message() in jazzy with rmw_fastrtps: frame "b", 1.5 s, joint "a", position 1.
  // clang-format off
  const Bytes message = {
      0, 1, 0, 0, 1, 0, 0, 0, 0, 0x65, 0xcd, 0x1d,                 // stamp
      2, 0, 0, 0, 'b', 0, 0x6f, 0x6e,                              // frame
      1, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0, 0,                        // name
      1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f,                    // position
      0, 0, 0, 0, 0, 0, 0, 0,                                      // neither velocity nor effort
      1, 0, 0, 0, 0xb0, 0x7d, 0xc4, 0x46,                          // of no meaning
  };
  // clang-format on
  const JointStateBlock block = blockOf({message, message});
  EXPECT_EQ(block.joint_names, Strings{"a"});
  EXPECT_THAT(block.position.values, ElementsAre(1, 1));
  EXPECT_EQ(block.velocity.columns + block.effort.columns, 0U);
}

TEST(JointStateDecoder, ChecksLengthsBeforeTakingMemory) {
  for (const std::size_t at : kLengths) {
    for (const std::uint32_t length : {0x7fffffffU, 0xffffffffU, 0x20000000U, 1000U}) {
      Bytes message = kMessage;
      std::memcpy(&message[at], &length, 4);
      EXPECT_THROW(layoutOf(message.data(), message.size()), DamageError) << at << " " << length;
    }
  }
}

TEST(JointStateDecoder, RefusesStringsWithoutClosingZeroAndOtherThanUtf8) {
  const std::pair<std::size_t, std::uint8_t> mistakes[] = {
      {43, 'e'}, {12, 0}, {40, 0xff}, {40, 0xed}};
  for (const auto& [at, byte] : mistakes) {
    Bytes message = kMessage;
    message[at] = byte;
    EXPECT_THROW(layoutOf(message.data(), message.size()), DamageError) << at;
  }
}

TEST(JointStateDecoder, KeepsZerosWithinAName) {
  Bytes message = kMessage;
  message[41] = 0;
  EXPECT_EQ(layoutOf(message.data(), message.size()).names[1], std::string("b\0d", 3));
}

TEST(JointStateDecoder, ReadsOrRefusesAnyBytes) {
  std::mt19937 random(1);
  int read = 0;
  for (int k = 0; k < 50'000; ++k) {
    Bytes message(kMessage.begin(), kMessage.end() - (k % 5 == 0 ? random() % 20 : 0));
    for (unsigned changes = random() % 4; changes > 0; --changes) {
      message[random() % message.size()] = static_cast<std::uint8_t>(random());
    }
    JointStateDecoder decoder;
    try {
      decoder.decode(kMessage.data(), kMessage.size());
      const JointSample sample = decoder.decode(message.data(), message.size());
      const double* const end = sample.position.data + sample.position.size;
      ASSERT_EQ(end, sample.velocity.data);
      ++read;
    } catch (const DamageError&) {
    }
  }
  EXPECT_GT(read, 10'000);
}

TEST(Utf8, IsWhatTheStandardSays) {
  for (const char* text :
       {"", "a", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_NO_THROW(requireUtf8(text, "text")) << text;
  }
  for (const char* text : {"\x80", "\xc3", "\xc0\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80",
                           "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\xe2\x28\xa1"}) {
    EXPECT_THROW(requireUtf8(text, "text"), DamageError) << text;
  }
}

}  // namespace inverse_dynamics_evaluation::joint_states_test
