// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages of a recording, file by file.
#pragma once

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "recording_content.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Messages of a topic: as many as the recording states. No topic: of all, any number.
class Messages : public MessageSource {
 public:
  Messages(std::shared_ptr<const RecordingContent> content, std::string topic)
      : content_(std::move(content)),
        topic_(std::move(topic)),
        where_(content_->path + ": " + topic_) {
    for (const Connection& connection : content_->connections) {
      if (!isWanted(connection)) continue;
      expected_ += connection.messages;
      if (connection.serialization == "cdr") continue;
      throw RecordingError(
          content_->path + ": topic " + chain_dynamics::printable(connection.topic, 60) +
          ": serialization: expected cdr, got " + quoted(connection.serialization) +
          "; was the recording edited? Copy or record it again");
    }
  }

  bool next(Message& message) override {
    const bool found = readable(content_->path, [&] { return nextOfFiles(message); });
    if (!topic_.empty()) check(found, message.received);
    return found;
  }

  void rewind() override {
    reader_.reset();
    file_ = 0;
    done_ = 0;
  }

 private:
  bool nextOfFiles(Message& message) {
    while (reader_ != nullptr || file_ < content_->files.size()) {
      if (reader_ == nullptr) openNextFile();
      if (reader_->next(message)) {
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

  void openNextFile() {
    reader_ = content_->open(content_->files[file_++]);
    std::vector<bool> wanted;
    for (const Connection& there : reader_->connections()) {
      wanted.push_back(isWanted(there) && there.serialization == "cdr" && isOfRecording(there));
    }
    reader_->select(wanted);
  }

  bool isWanted(const Connection& connection) const {
    return topic_.empty() || connection.topic == topic_;
  }

  // Whether the recording states a connection of a file.
  bool isOfRecording(const Connection& there) const {
    return std::any_of(content_->connections.begin(), content_->connections.end(),
                       [&](const Connection& stated) {
                         return stated.topic == there.topic && stated.type == there.type;
                       });
  }

  // As many messages as the recording states, received within the years 1970 to 2116.
  void check(bool found, std::int64_t received) {
    if (found ? ++done_ > expected_ : done_ != expected_) {
      throw RecordingError(
          where_ + ": expected " + counted(expected_, "message") + ", as its metadata say, got " +
          (found ? "more: they belong to another recording; run `ros2 bag reindex` on it"
                 : std::to_string(done_) + ": the file is cut off; copy or record it again"));
    }
    if (found && (received < 0 || received > kLatestReception)) {
      throw RecordingError(where_ + ", message " + std::to_string(done_) +
                           ": time of reception: expected 0 to 4.6e+18 ns, got " +
                           std::to_string(received) +
                           "; was the recording edited? Record it again");
    }
  }

  std::shared_ptr<const RecordingContent> content_;
  std::string topic_, where_;
  std::int64_t expected_ = 0, done_ = 0;  // messages
  std::size_t file_ = 0;                  // number of the next one
  std::unique_ptr<StorageReader> reader_;
  ZstdUnpacker zstd_;
  Bytes unpacked_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
