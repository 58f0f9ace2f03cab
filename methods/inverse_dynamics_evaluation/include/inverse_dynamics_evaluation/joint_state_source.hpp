// SPDX-License-Identifier: Apache-2.0

/// @file
/// Recorded joint states, message by message, whatever the storage.
///
///     JointSample sample;
///     while (source.next(sample)) use(*sample.names, sample.position.data[0]);
///     source.rewind();                                // for a second pass

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// The state of some joints in a message; its memory is the source's.
///
/// A field has as many numbers as there are names, or none. Other lengths are mistakes in the
/// recording; the reader of the sample reports them.
struct JointSample {
  struct Numbers {
    const double* data = nullptr;
    std::size_t size = 0;
  };

  const std::vector<std::string>* names = nullptr;
  Numbers position;                ///< rad (prismatic m)
  Numbers velocity;                ///< rad/s (prismatic m/s)
  Numbers effort;                  ///< as recorded: N m, A, ...
  Numbers acceleration;            ///< rad/s^2 (prismatic m/s^2); empty where none is recorded
  std::int64_t header_stamp = 0;   ///< ns, as the publisher wrote it
  std::int64_t receive_stamp = 0;  ///< ns, as the recorder wrote it
  std::int64_t message = 0;        ///< number of its message, counted from 0
  std::int64_t point = -1;         ///< number of it in a message with several, counted from 0
  std::string_view frame_id;       ///< of the header
};

/// Joint states of one topic of a recording.
class JointStateSource {
 public:
  JointStateSource() = default;
  JointStateSource(const JointStateSource&) = delete;
  JointStateSource& operator=(const JointStateSource&) = delete;
  virtual ~JointStateSource() = default;

  /// The next sample, valid until the next call; false after the last one.
  ///
  /// @throws RecordingError [error.hpp]
  virtual bool next(JointSample& sample) = 0;

  /// Makes the first sample the next one. @throws RecordingError
  virtual void rewind() = 0;

  /// Number of messages that the recording states.
  virtual std::int64_t expectedMessages() const = 0;

  /// File and topic, for error texts: `recording: /joint_states`.
  virtual std::string where() const = 0;

  /// How samples were made of messages, after the last one; empty: as they are.
  virtual std::string note() const { return ""; }
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
