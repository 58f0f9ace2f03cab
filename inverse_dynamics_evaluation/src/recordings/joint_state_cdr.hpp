// SPDX-License-Identifier: Apache-2.0
/// @file
/// Serialized sensor_msgs/JointState messages.
///
/// CDR: 4 bytes of encapsulation, whose second byte is 1 for numbers with their least byte first and
/// 0 for the other order; then the fields, each aligned to its own size, counted from the fifth byte:
///
///     int32 sec, uint32 nanosec, string frame_id, string[] name, float64[] position, velocity, effort
///
/// Strings and arrays begin with their length (uint32); a string's length counts its closing zero.
/// Bytes of padding mean nothing and may hold anything. Some middleware fills messages up to a
/// multiple of 4 bytes.
///
/// A recording repeats the same joints in every message: its messages have the same bytes in the
/// same places but for the stamp and the numbers. So a message is compared with the one before, and
/// only one that differs is taken apart field by field.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <string>
#include <vector>

#include "bytes.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using inverse_dynamics_evaluation::JointStateBlock;

/// Where the numbers of an array lie within a message.
struct CdrArray {
  std::size_t offset = 0;  // in bytes
  std::size_t count = 0;   // of numbers
};

/// What a message holds besides its stamp and its numbers.
struct JointStateLayout {
  bool little_endian = true;
  std::string frame_id;
  std::vector<std::string> names;
  std::array<CdrArray, 3> arrays;  ///< position, velocity, effort

  /// Whether messages may be in one block.
  bool isLike(const JointStateLayout& other) const;
};

/// Takes a message apart. @throws DamageError: it isn't a JointState.
JointStateLayout layoutOf(const std::uint8_t* message, std::size_t size);

/// Collects messages into blocks.
class JointStateDecoder {
 public:
  /// Adds a message to a block, unless it is unlike those that are there, or the block is full.
  ///
  /// @returns whether it was added. @throws DamageError: it isn't a JointState.
  bool add(const std::uint8_t* message, std::size_t size, std::int64_t received,
           JointStateBlock& block);

 private:
  bool repeatsLast(const std::uint8_t* message, std::size_t size) const;
  void remember(const std::uint8_t* message, std::size_t size, JointStateLayout layout);
  void begin(JointStateBlock& block) const;
  void append(const std::uint8_t* message, std::int64_t received, JointStateBlock& block) const;

  JointStateLayout layout_;  // of the message added last
  Bytes head_;               // its bytes up to its positions; none where it isn't little-endian
  std::size_t size_ = 0;
};

/// Makes messages of one publisher.
class JointStateEncoder {
 public:
  /// @param columns  how many numbers position, velocity and effort have.
  JointStateEncoder(const std::vector<std::string>& names, const std::string& frame_id,
                    const std::array<std::size_t, 3>& columns);

  /// Size of each message, in bytes.
  std::size_t size() const { return template_.size(); }

  /// Whether there are numbers for each field that messages have.
  bool fits(const std::array<const double*, 3>& numbers) const;

  /// Writes size() bytes.
  ///
  /// @param stamp    ns; its seconds fit 32 bits.
  /// @param numbers  of position, velocity, effort; null where there are none.
  void write(std::int64_t stamp, const std::array<const double*, 3>& numbers,
             std::uint8_t* out) const;

 private:
  Bytes template_;  // a message of zeros
  std::array<CdrArray, 3> arrays_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
