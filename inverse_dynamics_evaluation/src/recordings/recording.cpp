// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/recording.hpp"

#include <chain_dynamics/text.hpp>
#include <inverse_dynamics_evaluation/error.hpp>
#include <map>
#include <optional>
#include <utility>

#include "joint_states.hpp"
#include "paths.hpp"
#include "recording_content.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

std::string name(Storage storage) { return storage == Storage::kMcap ? "mcap" : "sqlite3"; }

RecordingContent::RecordingContent(std::string given_path) : path(std::move(given_path)) {
  readable(path, [this] { read(); });
}

void RecordingContent::read() {
  const Place place = placeOf(path);
  if (place == Place::kDirectory) {
    Metadata metadata = readMetadata(path + "/metadata.yaml");
    storage = metadata.storage;
    compression = metadata.compression;
    connections = std::move(metadata.connections);
    for (const std::string& file : metadata.files) files.push_back(path + "/" + file);
    requireFiles(files);
    return;
  }
  storage = place == Place::kMcapFile ? Storage::kMcap : Storage::kSqlite3;
  files = {path};
  const auto reader = open(path);
  reader->countMessages();
  connections = reader->connections();
}

// What is unpacked loses its name as soon as it is open.
std::unique_ptr<StorageReader> RecordingContent::open(const std::string& file) const {
  std::optional<UnpackedFile> unpacked;
  if (compression == Compression::kFiles) unpacked.emplace(file);
  const std::string& plain = unpacked ? unpacked->path() : file;
  return storage == Storage::kMcap ? openMcap(plain) : openSqlite(plain);
}

Recording::Recording(const std::string& path)
    : content_(std::make_shared<RecordingContent>(path)) {}

const std::string& Recording::path() const { return content_->path; }

Storage Recording::storage() const { return content_->storage; }

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
  return messagesOf(content_, topic);
}

std::unique_ptr<MessageSource> Recording::allMessages() const { return messagesOf(content_, ""); }

std::unique_ptr<JointStateSource> Recording::jointStates(const std::string& topic) const {
  const std::string chosen = topicOfType(kJointState, topic);
  return jointStatesOf(messages(chosen), path() + ": " + chosen, expectedMessages(chosen));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
