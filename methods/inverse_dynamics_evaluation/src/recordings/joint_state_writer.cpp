// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/joint_state_writer.hpp"

#include <algorithm>
#include <array>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <inverse_dynamics_evaluation/error.hpp>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "joint_state_encoder.hpp"
#include "metadata.hpp"
#include "storage_writer.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::RecordingError;

namespace {

// Calls a function; what can't be written is an error with the path.
template <class Function>
void writable(const std::string& path, Function function) {
  try {
    function();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const RecordingError&) {
    throw;
  } catch (const std::exception& error) {
    throw RecordingError(path + ": can't be written (" +
                         chain_dynamics::printable(error.what(), 300) +
                         "); free some space, or name another output with --out");
  }
}

void makeDirectory(const std::string& path) {
  if (fs::exists(fs::symlink_status(path)) || !fs::create_directories(path)) {
    throw std::runtime_error(path + " exists already, not overwriting");
  }
}

}  // namespace

class JointStateWriter::Content {
 public:
  Content(std::string path, Storage storage, const std::vector<JointStateTopic>& topics)
      : path_(std::move(path)) {
    const fs::path given = fs::absolute(path_);
    directory_ = given.has_filename() ? given : given.parent_path();  // "bag/"
    summary_.storage = storage;
    summary_.file = directory_.filename().string() + (storage == Storage::kMcap ? ".mcap" : ".db3");
    summary_.start = std::numeric_limits<std::int64_t>::max();
    std::vector<std::string> names;
    for (const JointStateTopic& topic : topics) {
      const std::size_t n = topic.joint_names.size();
      encoders_.emplace_back(
          topic.joint_names, topic.frame_id,
          std::array<std::size_t, 3>{n, topic.with_velocities ? n : 0, topic.with_efforts ? n : 0});
      columns_.push_back(n);
      summary_.topics.emplace_back(topic.name, 0);
      names.push_back(topic.name);
    }
    makeDirectory(path_);
    const std::string file = directory_ / summary_.file;
    try {
      storage_ = storage == Storage::kMcap ? createMcap(file, names) : createSqlite(file, names);
    } catch (...) {
      remove();
      throw;
    }
  }
  ~Content() { remove(); }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  // Calls a function; if it fails, nothing is left.
  template <class Function>
  void act(Function function) {
    if (closed_) throw RecordingError(path_ + ": is complete, or was given up after an error");
    try {
      writable(path_, function);
    } catch (...) {
      remove();
      throw;
    }
  }

  void write(const std::vector<JointStateRows>& rows) {
    requireFit(rows);
    std::size_t longest = 0;
    for (const JointStateRows& some : rows) longest = std::max(longest, some.count);
    for (std::size_t row = 0; row < longest; ++row) {
      for (std::size_t topic = 0; topic < rows.size(); ++topic) {
        if (row < rows[topic].count) write(topic, rows[topic], row);
      }
    }
  }

  void finish() {
    summary_.end = std::max(summary_.start, summary_.end);
    storage_->finish(metadataText(summary_, true));
    const std::string text = metadataText(summary_, false);
    OutputFile file(directory_ / "metadata.yaml");
    file.write(text.data(), text.size());
    file.close();
    closed_ = true;
  }

  // Removes an incomplete recording; files of others in its directory stay.
  void remove() noexcept {
    if (closed_) return;
    closed_ = true;
    storage_.reset();
    std::error_code none;
    for (const fs::path& made :
         {directory_ / summary_.file, directory_ / "metadata.yaml", directory_}) {
      fs::remove(made, none);
    }
  }

 private:
  void requireFit(const std::vector<JointStateRows>& rows) const {
    if (rows.size() != encoders_.size()) {
      throw RecordingError(path_ + ": expected rows of each topic, " +
                           std::to_string(encoders_.size()) + ", got " +
                           std::to_string(rows.size()));
    }
    for (std::size_t topic = 0; topic < rows.size(); ++topic) {
      const JointStateRows& some = rows[topic];
      if (some.count == 0) continue;
      const bool has_stamps = some.header_stamps != nullptr && some.receive_stamps != nullptr;
      if (!has_stamps || !encoders_[topic].fits({some.position, some.velocity, some.effort})) {
        throw RecordingError(place(topic) + "expected numbers of each field that the topic has");
      }
    }
  }

  std::string place(std::size_t topic) const {
    return path_ + ": " + chain_dynamics::printable(summary_.topics[topic].first, 60) + ": ";
  }

  // A stamp of a message has seconds of 32 bits; what is read was received within kLatestReception.
  void requireStamps(std::size_t topic, std::int64_t header, std::int64_t received) const {
    constexpr std::int64_t kHeader = (std::int64_t{1} << 31U) * 1'000'000'000;
    const bool is_header = header < -kHeader || header >= kHeader;
    if (!is_header && received >= 0 && received <= kLatestReception) return;
    throw RecordingError(
        place(topic) +
        (is_header ? "a time of the header: expected the years 1901 to 2038, got "
                   : "a time of reception: expected the years 1970 to 2116, got ") +
        std::to_string(is_header ? header : received) + " ns; correct the stamps of the samples");
  }

  void write(std::size_t topic, const JointStateRows& rows, std::size_t row) {
    const JointStateEncoder& encoder = encoders_[topic];
    const std::int64_t header = rows.header_stamps[row], received = rows.receive_stamps[row];
    requireStamps(topic, header, received);
    const auto at = [&](const double* numbers) {
      return numbers == nullptr ? nullptr : numbers + row * columns_[topic];
    };
    message_.resize(encoder.size());
    encoder.write(header, {at(rows.position), at(rows.velocity), at(rows.effort)}, message_.data());
    storage_->write(topic, received, message_.data(), message_.size());
    summary_.start = std::min(summary_.start, received);
    summary_.end = std::max(summary_.end, received);
    ++summary_.topics[topic].second;
  }

  std::string path_;
  fs::path directory_;
  MetadataSummary summary_;
  std::vector<JointStateEncoder> encoders_;
  std::vector<std::size_t> columns_;
  std::unique_ptr<StorageWriter> storage_;
  Bytes message_;
  bool closed_ = false;  // complete, or removed
};

JointStateWriter::JointStateWriter(const std::string& path, Storage storage,
                                   std::vector<JointStateTopic> topics) {
  writable(path, [&] { content_ = std::make_unique<Content>(path, storage, topics); });
}

JointStateWriter::~JointStateWriter() = default;

void JointStateWriter::write(const std::vector<JointStateRows>& rows) {
  content_->act([&] { content_->write(rows); });
}

void JointStateWriter::finish() {
  content_->act([&] { content_->finish(); });
}

void writeTorques(const std::string& path, Storage storage, const JointStateTopic& topic,
                  const JointStateRows& computed, const double* measured,
                  const std::function<void(double)>& progress) {
  constexpr std::size_t kAtOnce = 4096;  // messages of each topic between two calls of progress
  std::vector<JointStateTopic> topics(measured == nullptr ? 1 : 2, topic);
  topics.back().name += measured == nullptr ? "" : "_gt";
  const std::size_t n = topic.joint_names.size();
  JointStateWriter writer(path, storage, topics);
  for (std::size_t first = 0; first < computed.count; first += kAtOnce) {
    if (progress) progress(static_cast<double>(first) / static_cast<double>(computed.count));
    const auto from = [&](const double* efforts) {
      return JointStateRows{std::min(kAtOnce, computed.count - first),
                            computed.header_stamps + first,
                            computed.receive_stamps + first,
                            computed.position + first * n,
                            computed.velocity + first * n,
                            efforts + first * n};
    };
    std::vector<JointStateRows> rows = {from(computed.effort)};
    if (measured != nullptr) rows.push_back(from(measured));
    writer.write(rows);
  }
  writer.finish();
  if (progress) progress(1.0);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
