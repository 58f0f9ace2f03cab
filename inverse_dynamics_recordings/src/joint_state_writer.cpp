// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_recordings/joint_state_writer.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <filesystem>
#include <inverse_dynamics_evaluation/error.hpp>
#include <limits>
#include <utility>

#include "joint_state_cdr.hpp"
#include "metadata.hpp"
#include "output_file.hpp"
#include "storage_writer.hpp"

namespace inverse_dynamics_recordings {
inline namespace v2 {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::RecordingError;

namespace {

// As `ros2 interface show` has it, without comments: a part per type.
const char* definitionOfJointState() {
  return "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
         "float64[] effort\n"
         "================================================================================\n"
         "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
         "================================================================================\n"
         "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
}

constexpr char kHash[] = "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";

// Calls a function; what can't be written is an error with the path.
template <class Function>
void writable(const std::string& path, Function function) {
  try {
    function();
  } catch (const std::bad_alloc&) {
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
    const fs::path given = path_;
    const fs::path directory = given.has_filename() ? given : given.parent_path();  // "bag/"
    summary_.storage = storage;
    summary_.file = directory.filename().string() + (storage == Storage::kMcap ? ".mcap" : ".db3");
    summary_.start = std::numeric_limits<std::int64_t>::max();
    for (const JointStateTopic& topic : topics) {
      const std::size_t n = topic.joint_names.size();
      encoders_.emplace_back(
          topic.joint_names, topic.frame_id,
          std::array<std::size_t, 3>{n, topic.with_velocities ? n : 0, topic.with_efforts ? n : 0});
      columns_.push_back(n);
      summary_.connections.push_back(
          {topic.name, kJointState, 0, "cdr", "", definitionOfJointState(), kHash});
    }
    makeDirectory(path_);
    const std::string file = directory / summary_.file;
    storage_ = storage == Storage::kMcap ? createMcap(file, summary_.connections)
                                         : createSqlite(file, summary_.connections);
  }

  const std::string& path() const { return path_; }

  void write(const std::vector<JointStateRows>& rows) {
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
    OutputFile file(fs::path(path_) / "metadata.yaml");
    file.write(text.data(), text.size());
    file.close();
  }

 private:
  void write(std::size_t topic, const JointStateRows& rows, std::size_t row) {
    const JointStateEncoder& encoder = encoders_[topic];
    const auto at = [&](const double* numbers) {
      return numbers == nullptr ? nullptr : numbers + row * columns_[topic];
    };
    message_.resize(encoder.size());
    encoder.write(rows.header_stamps[row], {at(rows.position), at(rows.velocity), at(rows.effort)},
                  message_.data());
    const std::int64_t received = rows.receive_stamps[row];
    storage_->write(topic, received, message_.data(), message_.size());
    summary_.start = std::min(summary_.start, received);
    summary_.end = std::max(summary_.end, received);
    ++summary_.connections[topic].messages;
  }

  std::string path_;
  MetadataSummary summary_;
  std::vector<JointStateEncoder> encoders_;
  std::vector<std::size_t> columns_;
  std::unique_ptr<StorageWriter> storage_;
  Bytes message_;
};

JointStateWriter::JointStateWriter(const std::string& path, Storage storage,
                                   std::vector<JointStateTopic> topics) {
  writable(path, [&] { content_ = std::make_unique<Content>(path, storage, topics); });
}

JointStateWriter::~JointStateWriter() = default;

void JointStateWriter::write(const std::vector<JointStateRows>& rows) {
  writable(content_->path(), [&] { content_->write(rows); });
}

void JointStateWriter::finish() {
  writable(content_->path(), [&] { content_->finish(); });
}

}  // namespace v2
}  // namespace inverse_dynamics_recordings
