// SPDX-License-Identifier: Apache-2.0

/// @file
/// rosbag2 recordings (sqlite3 and MCAP), read without ROS.
///
///     const Recording recording("motion");
///     const auto source = recording.jointStates();  // of the only topic with joint states
///     JointStateBlock block;
///     while (source->next(block)) use(block);
///
/// A recording is a directory with a metadata.yaml, or one .db3 or .mcap file. It may be split into
/// several files, and compressed (zstd; chunks of MCAP files also with lz4). Messages come in the
/// order in which they were received, file by file.
///
/// Whatever a file states is checked before memory is taken for it. What is compressed may unpack
/// to 256 MB per message, chunk or file, or to 50 times its size if that is more, and so may the
/// chunks of an MCAP file that overlap in time together; the environment variable
/// IDS_UNPACK_LIMIT_MB replaces 256.
///
/// A recording that can't be read is an inverse_dynamics_evaluation::RecordingError.

#pragma once

#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <memory>
#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What a recording is kept in.
enum class Storage { kSqlite3, kMcap };

/// `sqlite3` or `mcap`, as in metadata.yaml.
std::string name(Storage storage);

/// The type of joint states.
inline constexpr char kJointState[] = "sensor_msgs/msg/JointState";

/// What a recording states about the messages of one publisher, or of several that are alike.
struct Connection {
  std::string topic;
  std::string type;             ///< such as `sensor_msgs/msg/JointState`
  std::int64_t messages = 0;    ///< how many
  std::string serialization;    ///< `cdr`
  std::string qos_profiles;     ///< YAML; empty where there are none
  std::string definition;       ///< of the type, in ROS 2's own language; empty where there is none
  std::string definition_hash;  ///< `RIHS01_...`; empty where the recording doesn't hold it
};

/// Times of reception are 0 to this number of ns, so that their differences fit 64 bits.
inline constexpr std::int64_t kLatestReception = std::int64_t{1} << 62U;

/// A topic, of one connection or several.
struct Topic {
  std::string name;
  std::string type;           ///< `several types` if its connections differ
  std::int64_t messages = 0;  ///< how many
};

/// A message as it is stored, looked at where it lies.
struct Message {
  std::size_t connection = 0;          ///< index of its connection
  std::int64_t received = 0;           ///< ns, as the recorder wrote it
  const std::uint8_t* data = nullptr;  ///< serialized; valid until the next call of the source
  std::size_t size = 0;                ///< bytes
};

/// Messages of a recording, one after another.
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

/// A recording that is open. Copies share it; sources that it has given stay valid without it.
///
/// Threads: a recording may be used by several, each of its sources by one at a time.
class Recording {
 public:
  /// Finds out what there is. @throws RecordingError
  explicit Recording(const std::string& path);

  const std::string& path() const;
  Storage storage() const;

  /// In the order of the recording. Definitions are empty: see definitions().
  const std::vector<Connection>& connections() const;

  /// The connections with definitions of their types, which need a look into files.
  std::vector<Connection> definitions() const;

  /// By name.
  std::vector<Topic> topics() const;

  /// Name of the topic of a type: the one given; none given: the only one with messages.
  ///
  /// @throws RecordingError: none, several, or of another type; the text lists the topics.
  std::string topicOfType(const std::string& type, const std::string& topic = "") const;

  /// How many messages a topic has by the recording's own account.
  std::int64_t expectedMessages(const std::string& topic) const;

  /// All messages of a topic, as many as the recording states, each received within the years
  /// 1970 to 2116: anything else is an error at the message where it shows.
  ///
  /// @throws RecordingError: their serialization isn't CDR.
  std::unique_ptr<MessageSource> messages(const std::string& topic) const;

  /// All messages of all topics, as they are. @throws RecordingError: one isn't serialized as CDR.
  std::unique_ptr<MessageSource> allMessages() const;

  /// Joint states of a topic; none given: of the only one with joint states.
  ///
  /// @throws RecordingError: see topicOfType(); by the source also: a message that can't be decoded.
  std::unique_ptr<inverse_dynamics_evaluation::JointStateSource> jointStates(
      const std::string& topic = "") const;

 private:
  struct Content;
  class Source;
  class CheckedSource;
  std::shared_ptr<const Content> content_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
