// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joint states of serialized messages [cdr.hpp].
#pragma once

#include <algorithm>
#include <array>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "cdr.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Fields of a message, in either order of bytes.
class CdrFields {
 public:
  CdrFields(const std::uint8_t* message, std::size_t size, bool little_endian)
      : message_(message), size_(size), little_endian_(little_endian) {}

  std::size_t offset() const { return at_; }

  std::uint32_t number() {
    at_ = cdrAligned(at_, 4);
    require(4);
    std::uint8_t bytes[4];
    std::copy_n(message_ + at_, 4, bytes);
    if (!little_endian_) std::reverse(bytes, bytes + 4);
    at_ += 4;
    return littleEndian<std::uint32_t>(bytes);
  }

  std::string string() {
    const std::size_t length = number();
    require(length);
    if (length == 0 || message_[at_ + length - 1] != 0) {
      throw DamageError("a string at offset " + std::to_string(at_) + " has no closing zero");
    }
    std::string text(reinterpret_cast<const char*>(message_ + at_), length - 1);
    requireUtf8(text, "a string");
    at_ += length;
    return text;
  }

  CdrArray array() {
    const std::size_t count = number();
    if (count == 0) return {at_, 0};
    at_ = cdrAligned(at_, 8);
    require(8 * count);
    const std::size_t begin = at_;
    at_ += 8 * count;
    return {begin, count};
  }

  /// @throws DamageError: fewer bytes are left.
  void require(std::size_t bytes) const {
    if (at_ > size_ || bytes > size_ - at_) {
      throw DamageError("expected " + std::to_string(bytes) + " bytes at offset " +
                        std::to_string(at_) + ", got a message of " + std::to_string(size_));
    }
  }

 private:
  const std::uint8_t* message_;
  std::size_t size_;
  bool little_endian_;
  std::size_t at_ = kCdrEncapsulation;
};

inline std::int64_t stampOf(const std::uint8_t* message, bool little_endian) {
  std::uint8_t bytes[8];
  std::copy_n(message + kCdrStamp, 8, bytes);
  if (!little_endian) {
    std::reverse(bytes, bytes + 4);
    std::reverse(bytes + 4, bytes + 8);
  }
  const std::int64_t seconds = littleEndian<std::int32_t>(bytes);
  return seconds * kSecond + littleEndian<std::uint32_t>(bytes + 4);
}

/// What a message holds besides its stamp and its numbers.
struct JointStateLayout {
  bool little_endian = true;
  std::string frame_id;
  std::vector<std::string> names;
  std::array<CdrArray, 3> arrays;  ///< position, velocity, effort
};

/// Takes a message apart. Bytes after its last field are ignored [cdr.hpp].
///
/// @throws DamageError: it isn't a JointState.
inline JointStateLayout layoutOf(const std::uint8_t* message, std::size_t size) {
  if (size < kCdrEncapsulation || message[0] != 0 || message[1] > 1) {
    throw DamageError("it doesn't begin with the encapsulation of plain CDR");
  }
  JointStateLayout layout;
  layout.little_endian = message[1] == 1;
  CdrFields fields(message, size, layout.little_endian);
  fields.number();  // sec
  fields.number();  // nanosec
  layout.frame_id = fields.string();
  const std::size_t names = fields.number();
  fields.require(5 * names);  // a length and a closing zero each
  for (std::size_t i = 0; i < names; ++i) layout.names.push_back(fields.string());
  for (CdrArray& array : layout.arrays) array = fields.array();
  return layout;
}

/// Decodes messages.
///
/// A recording repeats the same joints in every message: its messages have the same bytes in the
/// same places but for the stamp and the numbers. So a message is compared with the one before, and
/// only one that differs is taken apart field by field.
class JointStateDecoder {
 public:
  /// The joint states of a message, valid until the next call. @throws DamageError: it has none.
  JointSample decode(const std::uint8_t* message, std::size_t size) {
    if (!repeatsLast(message, size)) {
      layout_ = layoutOf(message, size);
      size_ = size;
      head_.clear();
      if (layout_.little_endian) head_.assign(message, message + layout_.arrays[0].offset);
      numbers_.resize(layout_.arrays[0].count + layout_.arrays[1].count + layout_.arrays[2].count);
    }
    JointSample sample;
    sample.names = &layout_.names;
    sample.frame_id = layout_.frame_id;
    sample.header_stamp = stampOf(message, layout_.little_endian);
    double* numbers = numbers_.data();
    JointSample::Numbers* const fields[] = {&sample.position, &sample.velocity, &sample.effort};
    for (std::size_t i = 0; i < layout_.arrays.size(); ++i) {
      const auto [offset, count] = layout_.arrays[i];
      if (count > 0) std::memcpy(numbers, message + offset, 8 * count);
      *fields[i] = {numbers, count};
      numbers += count;
    }
    if (!layout_.little_endian) {
      auto* const bytes = reinterpret_cast<std::uint8_t*>(numbers_.data());
      for (std::size_t i = 0; i < numbers_.size(); ++i)
        std::reverse(bytes + 8 * i, bytes + 8 * i + 8);
    }
    return sample;
  }

 private:
  // Padding may make messages of one layout differ: those are taken apart.
  bool repeatsLast(const std::uint8_t* message, std::size_t size) const {
    if (size != size_ || head_.empty() || message[0] != 0 || message[1] != 1 ||
        std::memcmp(message + kCdrFrame, head_.data() + kCdrFrame, head_.size() - kCdrFrame) != 0) {
      return false;
    }
    for (std::size_t i = 1; i < layout_.arrays.size(); ++i) {
      const CdrArray& before = layout_.arrays[i - 1];
      const std::size_t at = before.offset + 8 * before.count;
      if (littleEndian<std::uint32_t>(message + at) != layout_.arrays[i].count) return false;
    }
    return true;
  }

  JointStateLayout layout_;  // of the last message
  Bytes head_;               // its bytes up to its positions; none where it isn't little-endian
  std::size_t size_ = 0;
  std::vector<double> numbers_;
};

/// The joint states of messages.
class JointStates : public JointStateSource {
 public:
  /// @param where  for texts. @param expected  how many messages the recording states.
  /// @param note  what users should know of the recording.
  JointStates(std::unique_ptr<MessageSource> messages, std::string where, std::int64_t expected,
              std::string note = "")
      : messages_(std::move(messages)),
        where_(std::move(where)),
        note_(std::move(note)),
        expected_(expected) {}

  bool next(JointSample& sample) override {
    Message message;
    if (!messages_->next(message)) return false;
    try {
      if (message.data == nullptr && message.size == 0) throw DamageError("it holds no bytes");
      sample = decoder_.decode(message.data, message.size);
    } catch (const DamageError& error) {
      throw RecordingError(where_ + ", message " + std::to_string(done_ + 1) +
                           ": can't be decoded as " + kJointState + " (" +
                           chain_dynamics::printable(error.what(), 300) +
                           "): the recording is damaged; copy or record it again");
    }
    sample.receive_stamp = message.received;
    sample.message = done_++;
    return true;
  }

  void rewind() override {
    messages_->rewind();
    done_ = 0;
  }

  std::int64_t expectedMessages() const override { return expected_; }
  std::string where() const override { return where_; }
  std::string note() const override { return note_; }

 private:
  std::unique_ptr<MessageSource> messages_;
  std::string where_, note_;
  std::int64_t expected_, done_ = 0;
  JointStateDecoder decoder_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
