// SPDX-License-Identifier: Apache-2.0

/// @file
/// Recorded joint states as a stream of blocks, wherever they are stored.
///
///     JointStateBlock block;
///     while (source.next(block)) builder.add(block);  // JointLogBuilder [joint_log.hpp]
///     source.rewind();                                // for a second pass
///
/// A block is a run of messages, in the order of the recording, that have the same joint names,
/// the same frame and arrays of the same lengths. Its size is bounded, so a recording of any length
/// is read in bounded memory.

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// One field of N messages: N x columns numbers, one row per message.
struct JointStateNumbers {
  std::vector<double> values;  ///< row-major
  std::size_t columns = 0;     ///< numbers per message; 0: the field is empty

  /// Numbers of message i of the block.
  const double* row(std::size_t i) const { return values.data() + i * columns; }
};

/// N consecutive messages that differ in stamps and numbers only.
///
/// A publisher that leaves a field empty gives 0 columns; any number of columns other than that of
/// the names is a mistake in the recording, which whoever takes the block reports.
struct JointStateBlock {
  std::int64_t first = 0;                    ///< number of the first message, counted from 0
  std::vector<std::string> joint_names;      ///< of every message
  std::string frame_id;                      ///< of every message's header
  std::vector<std::int64_t> header_stamps;   ///< N; ns, as the publisher wrote them
  std::vector<std::int64_t> receive_stamps;  ///< N; ns, as the recorder wrote them
  JointStateNumbers position;                ///< rad (prismatic m)
  JointStateNumbers velocity;                ///< rad/s (prismatic m/s)
  JointStateNumbers effort;                  ///< as recorded: N m, A, ...

  /// N.
  std::size_t size() const { return receive_stamps.size(); }
};

/// Joint states of one topic of a recording.
class JointStateSource {
 public:
  JointStateSource() = default;
  JointStateSource(const JointStateSource&) = delete;
  JointStateSource& operator=(const JointStateSource&) = delete;
  virtual ~JointStateSource() = default;

  /// Replaces a block by the next messages, at least one; false after the last one.
  ///
  /// The memory of the block is used again. @throws RecordingError [error.hpp]
  virtual bool next(JointStateBlock& block) = 0;

  /// Makes the first message the next one. @throws RecordingError
  virtual void rewind() = 0;

  /// How many messages there are by the recording's own account.
  virtual std::int64_t expectedMessages() const = 0;

  /// File and topic, for error texts: `recording: /joint_states`.
  virtual std::string where() const = 0;

  /// The same and a message, whose number is counted from 0: `recording: /joint_states, message 3`.
  std::string place(std::int64_t message) const {
    return where() + ", message " + std::to_string(message + 1);
  }
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
