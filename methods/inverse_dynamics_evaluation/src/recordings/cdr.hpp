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
/// Bytes of padding mean nothing and may hold anything. So do bytes after the last field, which ROS's
/// own readers ignore too: middleware fills messages up to a multiple of 4 or 8 bytes, and jazzy's
/// serialize_message() appends 8 where two arrays are empty.
#pragma once

#include <cstddef>
#include <cstdint>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

inline constexpr std::size_t kCdrEncapsulation = 4;     ///< bytes, from which alignment is counted
inline constexpr std::size_t kCdrStamp = 4;             ///< offset of sec and nanosec
inline constexpr std::size_t kCdrFrame = 12;            ///< offset of the frame's length
inline constexpr std::int64_t kSecond = 1'000'000'000;  ///< ns

/// Where the numbers of an array lie within a message.
struct CdrArray {
  std::size_t offset = 0;  ///< in bytes
  std::size_t count = 0;   ///< of numbers
};

/// The first offset from this one on that a field of this size may have.
inline std::size_t cdrAligned(std::size_t offset, std::size_t size) {
  return kCdrEncapsulation + (offset - kCdrEncapsulation + size - 1) / size * size;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
