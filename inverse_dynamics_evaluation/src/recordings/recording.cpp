// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/recording.hpp"

#include <chain_dynamics/text.hpp>
#include <inverse_dynamics_evaluation/error.hpp>
#include <map>
#include <optional>
#include <utility>

#include "joint_state_cdr.hpp"
#include "metadata.hpp"
#include "paths.hpp"
#include "sqlite_database.hpp"
#include "storage_reader.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using inverse_dynamics_evaluation::JointStateSource;
using inverse_dynamics_evaluation::RecordingError;

namespace {

// Calls a function; what it says of a damaged file becomes an error of the recording.
template <class Function>
auto readable(const std::string& path, Function function) -> decltype(function()) {
  const auto damaged = [&path](const std::exception& error) {
    constexpr std::size_t kLongest = 300;
    return RecordingError(path + ": can't be read as a rosbag2 recording (" +
                          chain_dynamics::printable(error.what(), kLongest) +
                          "): expected sqlite3 or MCAP storage; it is damaged, cut off or of "
                          "another kind; copy or record it again");
  };
  try {
    return function();
  } catch (const RecordingError&) {
    throw;
  } catch (const ReadingError& error) {
    throw RecordingError(path + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {  // also of SQLite, of YAML and of the file system
    throw damaged(error);
  }
}

}  // namespace

std::string name(Storage storage) { return storage == Storage::kMcap ? "mcap" : "sqlite3"; }

// What a recording states, and where its files are.
struct Recording::Content {
  explicit Content(std::string given_path) : path(std::move(given_path)) {
    readable(path, [this] { read(); });
  }

  void read() {
    const Place place = placeOf(path);
    if (place == Place::kDirectory) {
      Metadata metadata = readMetadata(path + "/metadata.yaml");
      storage = metadata.storage;
      compression = metadata.compression;
      connections = std::move(metadata.connections);
      for (const std::string& file : metadata.files) files.push_back(path + "/" + file);
      requireFiles(files);
    } else {
      storage = place == Place::kMcapFile ? Storage::kMcap : Storage::kSqlite3;
      files = {path};
      const auto reader = open(path);
      reader->countMessages();
      connections = reader->connections();
      for (Connection& connection : connections) connection.definition.clear();
    }
  }

  // What is unpacked loses its name as soon as it is open.
  std::unique_ptr<StorageReader> open(const std::string& file) const {
    std::optional<UnpackedFile> unpacked;
    if (compression == Compression::kFiles) unpacked.emplace(file);
    const std::string& plain = unpacked ? unpacked->path() : file;
    return storage == Storage::kMcap ? openMcap(plain) : openSqlite(plain);
  }

  std::string path;
  Storage storage = Storage::kSqlite3;
  Compression compression = Compression::kNone;
  std::vector<std::string> files;
  std::vector<Connection> connections;
};

// Messages of the wanted connections, file by file.
class Recording::Source : public MessageSource {
 public:
  Source(std::shared_ptr<const Content> content, std::vector<bool> wanted)
      : content_(std::move(content)), wanted_(std::move(wanted)) {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const Connection& connection = content_->connections[i];
      if (!wanted_[i] || connection.serialization == "cdr") continue;
      throw RecordingError(
          content_->path + ": topic " + chain_dynamics::printable(connection.topic, 60) +
          ": serialization: expected cdr, got " + quoted(connection.serialization) +
          "; was the recording edited? Copy or record it again");
    }
  }

  bool next(Message& message) override {
    return readable(content_->path, [&] { return nextOfFiles(message); });
  }

  void rewind() override {
    reader_.reset();
    file_ = 0;
  }

 private:
  bool nextOfFiles(Message& message) {
    while (reader_ != nullptr || file_ < content_->files.size()) {
      if (reader_ == nullptr) openNextFile();
      if (reader_->next(message)) {
        message.connection = connections_[message.connection];
        if (content_->compression == Compression::kMessages && message.data != nullptr) {
          zstd_.unpack(message.data, message.size, "a message or chunk", unpacked_);
          message.data = unpacked_.data();
          message.size = unpacked_.size();
        }
        return true;
      }
      reader_.reset();
    }
    return false;
  }

  // Finds the connections of the file among those of the recording.
  void openNextFile() {
    const std::string file = content_->files[file_++];
    reader_ = content_->open(file);
    const std::vector<Connection>& there = reader_->connections();
    connections_.assign(there.size(), 0);
    std::vector<bool> wanted(there.size(), false);
    std::map<std::pair<std::string, std::string>, std::size_t> known;
    for (std::size_t i = 0; i < content_->connections.size(); ++i) {
      const Connection& connection = content_->connections[i];
      if (wanted_[i]) known.emplace(std::make_pair(connection.topic, connection.type), i);
    }
    for (std::size_t i = 0; i < there.size(); ++i) {
      const auto found = known.find({there[i].topic, there[i].type});
      if (found == known.end() || there[i].serialization != "cdr") continue;
      connections_[i] = found->second;
      wanted[i] = true;
    }
    reader_->select(wanted);
  }

  std::shared_ptr<const Content> content_;
  std::vector<bool> wanted_;
  std::size_t file_ = 0;  // number of the next one
  std::unique_ptr<StorageReader> reader_;
  std::vector<std::size_t> connections_;  // of the recording, for those of the file
  ZstdUnpacker zstd_;
  Bytes unpacked_;
};

// All messages of a topic, as many as the recording states.
class Recording::CheckedSource : public MessageSource {
 public:
  CheckedSource(std::unique_ptr<MessageSource> source, std::string where, std::int64_t expected)
      : source_(std::move(source)), where_(std::move(where)), expected_(expected) {}

  bool next(Message& message) override {
    if (!source_->next(message)) {
      if (done_ != expected_) failToCount(std::to_string(done_));
      return false;
    }
    if (++done_ > expected_) failToCount("more");
    if (message.received < 0 || message.received > kLatestReception) {
      throw RecordingError(where_ + ", message " + std::to_string(done_) +
                           ": time of reception: expected 0 to 4.6e+18 ns, got " +
                           std::to_string(message.received) +
                           "; was the recording edited? Record it again");
    }
    return true;
  }

  void rewind() override {
    source_->rewind();
    done_ = 0;
  }

 private:
  [[noreturn]] void failToCount(const std::string& got) const {
    throw RecordingError(where_ + ": expected " + counted(expected_, "message") +
                         ", as its metadata say, got " + got + ": " +
                         (got == "more" ? "they belong to another recording; run `ros2 bag "
                                          "reindex` on it"
                                        : "the file is cut off; copy or record it again"));
  }

  std::unique_ptr<MessageSource> source_;
  std::string where_;
  std::int64_t expected_, done_ = 0;
};

namespace {

// Joint states of messages, in blocks.
class JointStates : public JointStateSource {
 public:
  JointStates(std::unique_ptr<MessageSource> messages, std::string where, std::int64_t expected)
      : messages_(std::move(messages)), where_(std::move(where)), expected_(expected) {}

  bool next(JointStateBlock& block) override {
    block.first = done_;
    block.header_stamps.clear();
    block.receive_stamps.clear();
    for (auto* field : {&block.position, &block.velocity, &block.effort}) field->values.clear();
    while (take() && add(block)) {
      waiting_ = false;
      ++done_;
    }
    return block.size() > 0;
  }

  void rewind() override {
    messages_->rewind();
    waiting_ = false;
    done_ = 0;
  }

  std::int64_t expectedMessages() const override { return expected_; }
  std::string where() const override { return where_; }

 private:
  // Whether a message is waiting.
  bool take() {
    if (waiting_) return true;
    waiting_ = messages_->next(message_);
    return waiting_;
  }

  bool add(JointStateBlock& block) {
    try {
      if (message_.data == nullptr && message_.size == 0) throw DamageError("it holds no bytes");
      return decoder_.add(message_.data, message_.size, message_.received, block);
    } catch (const DamageError& error) {
      if (block.size() > 0) return false;  // whoever takes the block may find mistakes before
      throw RecordingError(place(done_) + ": can't be decoded as " + kJointState + " (" +
                           chain_dynamics::printable(error.what(), 300) +
                           "): the recording is damaged; copy or record it again");
    }
  }

  std::unique_ptr<MessageSource> messages_;
  std::string where_;
  std::int64_t expected_, done_ = 0;
  JointStateDecoder decoder_;
  Message message_;
  bool waiting_ = false;
};

}  // namespace

Recording::Recording(const std::string& path) : content_(std::make_shared<Content>(path)) {}

const std::string& Recording::path() const { return content_->path; }

Storage Recording::storage() const { return content_->storage; }

const std::vector<Connection>& Recording::connections() const { return content_->connections; }

std::vector<Connection> Recording::definitions() const {
  std::vector<Connection> connections = content_->connections;
  readable(content_->path, [&] {
    for (const std::string& file : content_->files) {
      const auto reader = content_->open(file);
      bool complete = true;
      for (Connection& connection : connections) {
        for (const Connection& there : reader->connections()) {
          if (!connection.definition.empty()) break;
          if (there.type == connection.type) connection.definition = there.definition;
        }
        complete = complete && !connection.definition.empty();
      }
      if (complete) break;
    }
  });
  return connections;
}

std::vector<Topic> Recording::topics() const {
  std::map<std::string, Topic> topics;
  for (const Connection& connection : content_->connections) {
    const auto [at, is_new] =
        topics.try_emplace(connection.topic, Topic{connection.topic, connection.type, 0});
    if (!is_new && at->second.type != connection.type) at->second.type = "several types";
    at->second.messages += connection.messages;
  }
  std::vector<Topic> found;
  found.reserve(topics.size());
  for (auto& [topic_name, topic] : topics) found.push_back(std::move(topic));
  return found;
}

std::string Recording::topicOfType(const std::string& type, const std::string& topic) const {
  constexpr std::size_t kLongest = 300;
  const auto line = [](const std::string& text) {
    return chain_dynamics::printable(text, kLongest);
  };
  const std::vector<Topic> there = topics();
  std::string list;
  std::vector<std::string> candidates, filled;
  for (const Topic& one : there) {
    list += (list.empty() ? "  " : "\n  ") + line(one.name) + "  " + line(one.type) + "  " +
            counted(one.messages, "message");
    if (one.type == type) candidates.push_back(one.name);
    if (one.type == type && one.messages > 0) filled.push_back(one.name);
  }
  const std::string& where = content_->path;
  if (there.empty()) {
    throw RecordingError(where + ": is an empty recording: it has no topic; record it again");
  }
  if (topic.empty()) {
    if (!filled.empty()) candidates = filled;
    if (candidates.size() == 1) return candidates.front();
    throw RecordingError(where + ": expected one topic of type " + type + ", got " +
                         std::to_string(candidates.size()) +
                         "; name it with --topic. The recording has\n" + list);
  }
  for (const Topic& one : there) {
    if (one.name != topic) continue;
    if (one.type == type) return topic;
    throw RecordingError(where + ": topic " + topic + ": expected type " + type + ", got " +
                         chain_dynamics::printable(one.type, 60) +
                         "; name another topic with --topic:\n" + list);
  }
  throw RecordingError(where + ": has no topic " + topic + "; name one it has with --topic:\n" +
                       list);
}

std::int64_t Recording::expectedMessages(const std::string& topic) const {
  std::int64_t messages = 0;
  for (const Connection& connection : content_->connections) {
    if (connection.topic == topic) messages += connection.messages;
  }
  return messages;
}

std::unique_ptr<MessageSource> Recording::messages(const std::string& topic) const {
  std::vector<bool> wanted;
  for (const Connection& connection : connections()) wanted.push_back(connection.topic == topic);
  return std::make_unique<CheckedSource>(std::make_unique<Source>(content_, std::move(wanted)),
                                         path() + ": " + topic, expectedMessages(topic));
}

std::unique_ptr<MessageSource> Recording::allMessages() const {
  return std::make_unique<Source>(content_, std::vector<bool>(connections().size(), true));
}

std::unique_ptr<JointStateSource> Recording::jointStates(const std::string& topic) const {
  const std::string chosen = topicOfType(kJointState, topic);
  return std::make_unique<JointStates>(messages(chosen), path() + ": " + chosen,
                                       expectedMessages(chosen));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
