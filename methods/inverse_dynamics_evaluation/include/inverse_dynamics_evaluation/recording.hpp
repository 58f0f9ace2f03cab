// SPDX-License-Identifier: Apache-2.0

/// @file
/// rosbag2 recordings (sqlite3 and MCAP), read without ROS.
///
///     const Recording recording("motion");
///     const auto source = recording.jointStates();  // of the only topic with joint states
///     JointSample sample;
///     while (source->next(sample)) use(sample);
///
/// A recording is a directory with a metadata.yaml, or one .db3 or .mcap file. It may be split into
/// several files, and compressed (zstd; chunks of MCAP files also with lz4). Messages come in the
/// order in which they were received, file by file.
///
/// Sizes that a file states are checked before memory is allocated. A compressed message, chunk or
/// file may unpack to 256 MB, or to 50 times its size if that is more; so may the chunks of an MCAP
/// file that overlap in time, together. The environment variable IDS_UNPACK_LIMIT_MB replaces 256.
///
/// A recording that can't be read is a RecordingError.

#pragma once

#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <memory>
#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// How a recording is stored.
enum class Storage { kSqlite3, kMcap };

/// `sqlite3` or `mcap`, as in metadata.yaml.
std::string name(Storage storage);

/// The type of joint states.
inline constexpr char kJointState[] = "sensor_msgs/msg/JointState";

/// Latest time of reception [ns]; the earliest is 0. Differences fit 64 bits.
inline constexpr std::int64_t kLatestReception = std::int64_t{1} << 62U;

/// A topic, of one publisher or several.
struct Topic {
  std::string name;
  std::string type;           ///< `several types` if its publishers' differ
  std::int64_t messages = 0;  ///< how many
};

/// A serialized message; its memory is the source's.
struct Message {
  const std::string* topic = nullptr;  ///< its name
  std::int64_t received = 0;           ///< ns, as the recorder wrote it
  const std::uint8_t* data = nullptr;  ///< valid until the next call of the source
  std::size_t size = 0;                ///< bytes
};

/// Messages of a recording, in order.
class MessageSource {
 public:
  MessageSource() = default;
  MessageSource(const MessageSource&) = delete;
  MessageSource& operator=(const MessageSource&) = delete;
  virtual ~MessageSource() = default;

  /// The next message; false after the last one. @throws RecordingError
  virtual bool next(Message& message) = 0;

  /// Makes the first message the next one. @throws RecordingError
  virtual void rewind() = 0;
};

struct RecordingContent;

/// An open recording. Copies share it; its sources outlive it.
///
/// Threads: several may use a recording, one at a time each source.
class Recording {
 public:
  /// @throws RecordingError
  explicit Recording(const std::string& path);

  const std::string& path() const;
  Storage storage() const;

  /// Sorted by name.
  std::vector<Topic> topics() const;

  /// The given topic, if it has this type; none given: the only topic of this type with messages.
  /// Several topics of joint states are joined by `+`.
  ///
  /// @throws RecordingError: no such topic, several, or another type; the text lists the topics.
  std::string topicOfType(const std::string& type, const std::string& topic = "") const;

  /// Number of messages of a topic that the recording states.
  std::int64_t expectedMessages(const std::string& topic) const;

  /// All messages of a topic. The source throws where there are more or fewer than the recording
  /// states, and at a time of reception outside the years 1970 to 2116.
  ///
  /// @throws RecordingError: their serialization isn't CDR.
  std::unique_ptr<MessageSource> messages(const std::string& topic) const;

  /// All messages of all topics; nobody counts them. @throws RecordingError: as messages().
  std::unique_ptr<MessageSource> allMessages() const;

  /// Joint states of a topic; none given: of the only topic with joint states.
  ///
  /// @throws RecordingError: as topicOfType(). The source throws at a message that can't be decoded.
  std::unique_ptr<JointStateSource> jointStates(const std::string& topic = "") const;

  /// Samples of all the joints, of a topic or of several, joined by `+`.
  ///
  /// Where messages have some of the joints each, or some of the fields, they are merged by time:
  /// samples have the times of the slowest messages; numbers of the others lie on straight lines
  /// between the two around that time. A sample is left out where these are further apart than 1.5
  /// times the slowest messages usually are. JointStateSource::note() says so.
  ///
  /// @throws RecordingError: as above; some number on none of several topics, or on two; messages
  ///         at the same times are never there.
  std::unique_ptr<JointStateSource> jointStates(const std::string& topic,
                                                const RecordingOptions& options) const;

  /// The usual topic, unless others alone or together have all the joints where it hasn't.
  ///
  /// @return topics joined by `+`. @throws RecordingError: as jointStates() does.
  std::string topicsWithJoints(const std::string& usual, const RecordingOptions& options) const;

 private:
  std::shared_ptr<const RecordingContent> content_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
