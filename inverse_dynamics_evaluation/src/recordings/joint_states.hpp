// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages of a recording, and joint states in them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "cdr.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

struct RecordingContent;

/// Messages of a topic, file by file: Recording::messages(); no topic: Recording::allMessages().
std::unique_ptr<MessageSource> messagesOf(std::shared_ptr<const RecordingContent> content,
                                          const std::string& topic);

/// What a message holds besides its stamp and its numbers.
struct JointStateLayout {
  bool little_endian = true;
  std::string frame_id;
  std::vector<std::string> names;
  std::array<CdrArray, 3> arrays;  ///< position, velocity, effort
};

/// Takes a message apart. @throws DamageError: it isn't a JointState.
JointStateLayout layoutOf(const std::uint8_t* message, std::size_t size);

/// Decodes messages.
///
/// A recording repeats the same joints in every message: its messages have the same bytes in the
/// same places but for the stamp and the numbers. So a message is compared with the one before, and
/// only one that differs is taken apart field by field.
class JointStateDecoder {
 public:
  /// The joint states of a message, valid until the next call. @throws DamageError: it has none.
  JointSample decode(const std::uint8_t* message, std::size_t size);

 private:
  bool repeatsLast(const std::uint8_t* message, std::size_t size) const;

  JointStateLayout layout_;  // of the last message
  Bytes head_;               // its bytes up to its positions; none where it isn't little-endian
  std::size_t size_ = 0;
  std::vector<double> numbers_;
};

/// The joint states of messages.
///
/// @param where     for texts. @param expected  how many messages the recording states.
std::unique_ptr<JointStateSource> jointStatesOf(std::unique_ptr<MessageSource> messages,
                                                std::string where, std::int64_t expected);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
