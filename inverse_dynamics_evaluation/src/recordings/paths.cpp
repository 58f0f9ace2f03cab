// SPDX-License-Identifier: Apache-2.0

#include "paths.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_evaluation/error.hpp>
#include <system_error>

#include "text.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::RecordingError;

namespace {

// The first byte of a file; 0 of an empty one, or where there is none.
char firstByte(const std::string& file) {
  char byte = 0;
  return std::ifstream(file, std::ios::binary).get(byte) ? byte : '\0';
}

// A recorder that was killed leaves messages in a log beside the database, or what it has changed
// last in a journal. A journal that is done with is empty or begins with zeros.
void requireComplete(const std::string& file) {
  if (firstByte(file + "-wal") != 0) {
    throw RecordingError(file + ": is incomplete: some of its messages are in " +
                         fs::path(file).filename().string() +
                         "-wal still; put them in with `sqlite3 " + file +
                         " 'PRAGMA wal_checkpoint(TRUNCATE)'`");
  }
  if (firstByte(file + "-journal") != 0) {
    throw RecordingError(file +
                         ": is incomplete: a change of it was interrupted; undo it with "
                         "`sqlite3 " +
                         file + " 'PRAGMA integrity_check'`");
  }
}

// A directory without metadata.yaml.
[[noreturn]] void refuseDirectory(const std::string& path) {
  std::vector<std::string> files, inside;
  for (const auto& entry : fs::directory_iterator(path)) {
    const fs::path& there = entry.path();
    if (there.extension() == ".db3" || there.extension() == ".mcap") files.push_back(there);
    std::error_code error;
    if (fs::exists(there / "metadata.yaml", error)) inside.push_back(there);
  }
  std::sort(files.begin(), files.end());
  std::sort(inside.begin(), inside.end());
  std::string remedy = "is it another directory?";
  if (!files.empty()) {
    remedy = "give " + files.front() + " itself, or run `ros2 bag reindex " + path + "`";
  } else if (inside.size() == 1) {
    remedy = "a recording is in it: give " + inside.front();
  } else if (!inside.empty()) {
    remedy = "recordings are in it: give one of " + inside.front();
    for (std::size_t i = 1; i < inside.size(); ++i) remedy += ", " + inside[i];
  }
  throw RecordingError(path + ": is not a rosbag2 recording: it has no metadata.yaml; " + remedy);
}

}  // namespace

Place placeOf(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw RecordingError(path +
                         ": no such file or directory; expected a rosbag2 recording (a directory "
                         "with metadata.yaml, or a .db3 or .mcap file), or a table (.csv or .txt)");
  }
  if (fs::is_directory(status)) {
    if (!fs::exists(path + "/metadata.yaml", error)) refuseDirectory(path);
    return Place::kDirectory;
  }
  const fs::path file(path);
  const std::string kind = file.extension();
  if (kind == ".bag") {
    throw RecordingError(path +
                         ": is a ROS 1 recording; expected rosbag2; convert it with "
                         "`rosbags-convert --src " +
                         path + " --dst " + file.stem().string() + "`");
  }
  if (kind != ".db3" && kind != ".mcap") {
    throw RecordingError(path +
                         ": is not a rosbag2 recording: expected a directory with metadata.yaml, "
                         "or a .db3 or .mcap file (or a table, .csv or .txt), got '" +
                         file.filename().string() + "'");
  }
  if (!fs::is_regular_file(status) || fs::file_size(path, error) == 0) {
    throw RecordingError(path +
                         ": is empty (0 bytes); expected a rosbag2 recording; copy or record it "
                         "again");
  }
  requireComplete(path);
  return kind == ".mcap" ? Place::kMcapFile : Place::kSqliteFile;
}

void requireFiles(const std::vector<std::string>& files) {
  std::string missing;
  for (const std::string& file : files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) missing += (missing.empty() ? "" : ", ") + quoted(file);
    requireComplete(file);
  }
  if (!missing.empty()) throw DamageError("some of its files are missing: " + missing);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
