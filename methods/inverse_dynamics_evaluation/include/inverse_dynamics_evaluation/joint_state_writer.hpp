// SPDX-License-Identifier: Apache-2.0

/// @file
/// New rosbag2 recordings of joint states (sqlite3 and MCAP), written without ROS.
///
///     JointStateWriter writer("torques", Storage::kMcap, {{"/torques", {"joint_1", "joint_2"}}});
///     writer.write({{stamps.size(), stamps.data(), stamps.data(), q.data(), qd.data(), tau.data()}});
///     writer.finish();
///
/// The format is rosbag2's current one: metadata.yaml of version 9, messages with an index by time,
/// definitions of the type. MCAP files hold chunks of about 1 MB with checksums, not compressed.
///
/// Failures to write are RecordingErrors. A recording is complete after finish(); before, an error or
/// the writer's destructor removes it.

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A topic of joint states, and the fields that its messages share.
struct JointStateTopic {
  std::string name;
  std::vector<std::string> joint_names;  ///< n
  std::string frame_id{};
  bool with_velocities = true;  ///< else the field is empty
  bool with_efforts = true;     ///< likewise
};

/// Views of consecutive messages of a topic; numbers are N x n, row-major.
struct JointStateRows {
  std::size_t count = 0;                         ///< N
  const std::int64_t* header_stamps = nullptr;   ///< N; ns, of the years 1901 to 2038
  const std::int64_t* receive_stamps = nullptr;  ///< N; ns, of the years 1970 to 2116
  const double* position = nullptr;              ///< rad (prismatic m)
  const double* velocity = nullptr;              ///< rad/s (prismatic m/s)
  const double* effort = nullptr;                ///< N m (prismatic N), or as the topic has it
};

/// Writes a recording.
class JointStateWriter {
 public:
  /// Makes the directory `path`, with those above it, and a file in it of the same name.
  ///
  /// @throws RecordingError: it exists, or can't be made.
  JointStateWriter(const std::string& path, Storage storage, std::vector<JointStateTopic> topics);
  ~JointStateWriter();
  JointStateWriter(const JointStateWriter&) = delete;
  JointStateWriter& operator=(const JointStateWriter&) = delete;

  /// Appends messages, one set of rows per topic: the first message of each topic, then the second
  /// ones, and so on. Topics may have different numbers of messages.
  ///
  /// @throws RecordingError
  void write(const std::vector<JointStateRows>& rows);

  /// Writes indexes and metadata. @throws RecordingError
  void finish();

 private:
  class Content;
  std::unique_ptr<Content> content_;
};

/// Writes a recording of torques: computed ones as `topic`, measured ones as `topic_gt`.
///
/// @param computed  all messages of the topic; N m (prismatic N).
/// @param measured  N x n, row-major; N m (prismatic N); null: there are none.
/// @param progress  callback with the share that is written, 0 to 1; throwing leaves no recording.
/// @throws RecordingError
void writeTorques(const std::string& path, Storage storage, const JointStateTopic& topic,
                  const JointStateRows& computed, const double* measured,
                  const std::function<void(double)>& progress = nullptr);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
