// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/recording.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_evaluation/error.hpp>
#include <ios>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "joint_state_decoder.hpp"
#include "mcap_format.hpp"
#include "merged_joint_states.hpp"
#include "messages.hpp"
#include "recording_content.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

namespace {

namespace fs = std::filesystem;

enum class Place { kDirectory, kParts, kFile };

// The first byte of a file; 0 of an empty one, or where there is none.
char firstByte(const std::string& file) {
  char byte = 0;
  return std::ifstream(file, std::ios::binary).get(byte) ? byte : '\0';
}

// A command; sqlite3, the program, needn't be installed.
std::string pragma(const std::string& what, const std::string& file) {
  return "`python3 -c \"import sqlite3, sys; sqlite3.connect(sys.argv[1]).execute('PRAGMA " + what +
         "')\" " + file + "`";
}

// A recorder that was killed leaves messages in a log beside the database, or what it has changed
// last in a journal. A journal that is done with is empty or begins with zeros.
void requireComplete(const std::string& file) {
  if (firstByte(file + "-wal") != 0) {
    throw RecordingError(file + ": is incomplete: some of its messages are in " +
                         fs::path(file).filename().string() + "-wal still; put them in with " +
                         pragma("wal_checkpoint(TRUNCATE)", file));
  }
  if (firstByte(file + "-journal") != 0) {
    throw RecordingError(file + ": is incomplete: a change of it was interrupted; undo it with " +
                         pragma("integrity_check", file));
  }
}

// The file of a recording, in storage that can be read.
bool isStorage(const fs::path& file) {
  return file.extension() == ".db3" || file.extension() == ".mcap";
}

// A recorder that splits its recording numbers the files: `run_0.mcap`, `run_1.mcap`.
struct NumberedFile {
  std::string recording;  // name without the number; empty: there is none
  std::uint64_t number = 0;
};

NumberedFile numbered(const fs::path& file) {
  constexpr std::size_t kMostDigits = 9;
  const std::string stem = file.stem();
  const std::size_t line = stem.find_last_of('_');
  if (line == std::string::npos || stem.size() - line - 1 > kMostDigits) return {};
  const std::string digits = stem.substr(line + 1);
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return {};
  return {stem.substr(0, line) + file.extension().string(), std::stoull(digits)};
}

// Puts the files of a split recording into the order of their numbers. False: they are called otherwise.
bool sortParts(std::vector<std::string>& files) {
  const std::string recording = files.empty() ? "" : numbered(files.front()).recording;
  for (const std::string& file : files) {
    if (recording.empty() || numbered(file).recording != recording) return false;
  }
  std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
    return numbered(a).number < numbered(b).number;
  });
  return true;
}

// Files in a directory that has no metadata.yaml: those of one recording, in order, or none.
std::vector<std::string> partsIn(const std::string& path) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (isStorage(entry.path())) files.push_back(entry.path());
  }
  if (files.size() != 1 && !sortParts(files)) files.clear();
  return files;
}

// A directory without metadata.yaml and without files of one recording.
[[noreturn]] void refuseDirectory(const std::string& path) {
  std::vector<std::string> files, inside;
  for (const auto& entry : fs::directory_iterator(path)) {
    const fs::path& there = entry.path();
    if (isStorage(there)) files.push_back(there);
    std::error_code error;
    if (fs::exists(there / "metadata.yaml", error)) inside.push_back(there);
  }
  std::sort(files.begin(), files.end());
  std::sort(inside.begin(), inside.end());
  std::string remedy = "is it another directory?";
  if (!files.empty()) {
    remedy = "give one of its files, such as " + files.front() +
             "; those of one recording are called NAME_0.mcap, NAME_1.mcap";
  } else if (inside.size() == 1) {
    remedy = "a recording is in it: give " + inside.front();
  } else if (!inside.empty()) {
    remedy = "recordings are in it: give one of " + inside.front();
    for (std::size_t i = 1; i < inside.size(); ++i) remedy += ", " + inside[i];
  }
  throw RecordingError(path + ": is not a rosbag2 recording: it has no metadata.yaml; " + remedy);
}

// What is said of a file of a split recording that is read alone; or nothing.
std::string partNote(const std::string& path) {
  const fs::path file(path);
  const std::string recording = numbered(file).recording;
  const fs::path directory = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::size_t others = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    const bool other = entry.path().filename() != file.filename();
    others += other && !recording.empty() && numbered(entry.path()).recording == recording ? 1 : 0;
  }
  if (others == 0) return "";
  return file.filename().string() + " is read alone; " +
         counted(static_cast<std::int64_t>(others), "other file") +
         " beside it may be of the same recording: give " + directory.string() + " to read all";
}

// By what a file begins with, as it may have been renamed; else by its name.
Storage storageOf(const std::string& file) {
  const char first = firstByte(file);
  const bool named = fs::path(file).extension() == ".mcap";
  return first == static_cast<char>(kMcapMagic[0]) || (named && first != 'S') ? Storage::kMcap
                                                                              : Storage::kSqlite3;
}

// What a path is.
Place placeOf(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw RecordingError(path +
                         ": no such file or directory; expected a rosbag2 recording (a directory "
                         "with metadata.yaml, or a .db3 or .mcap file), or a table (.csv or .txt)");
  }
  if (fs::is_directory(status)) {
    if (fs::exists(path + "/metadata.yaml", error)) return Place::kDirectory;
    if (partsIn(path).empty()) refuseDirectory(path);
    return Place::kParts;
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
                         "or a .db3 or .mcap file (or a table; rename one of text to .csv), got '" +
                         file.filename().string() + "'");
  }
  if (!fs::is_regular_file(status) || fs::file_size(path, error) == 0) {
    throw RecordingError(path +
                         ": is empty (0 bytes); expected a rosbag2 recording; copy or record it "
                         "again");
  }
  requireComplete(path);
  return Place::kFile;
}

void requireFiles(const std::vector<std::string>& files) {
  std::string missing;
  for (const std::string& file : files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) missing += (missing.empty() ? "" : ", ") + quoted(file);
    requireComplete(file);
  }
  if (missing.empty()) return;
  const std::vector<std::string> others = partsIn(fs::path(files.front()).parent_path());
  if (others.size() == 1) {
    throw ReadingError("metadata.yaml names " + missing + ", but the only file is " +
                       others.front() + "; if it was renamed, give " + others.front() + " itself");
  }
  throw DamageError("some of its files are missing: " + missing);
}

// Topics that are joined by +, which may also be in a name.
std::vector<std::string> partsOf(const Metadata& metadata, const std::string& topic) {
  std::vector<std::string> parts;
  const bool whole = std::any_of(metadata.connections.begin(), metadata.connections.end(),
                                 [&](const Connection& there) { return there.topic == topic; });
  std::size_t begin = 0;
  for (std::size_t at = topic.find('+'); !whole && at != std::string::npos;
       at = topic.find('+', begin)) {
    parts.push_back(topic.substr(begin, at - begin));
    begin = at + 1;
  }
  parts.push_back(topic.substr(begin));
  return parts;
}

// Whether the first message with any of the joints has all of them, with the fields that are needed. Of a
// joint that it names twice, the reader tells.
bool startsWithAll(JointStateSource& source, const RecordingOptions& options) {
  if (options.joints.empty()) return true;
  JointMatching matching(options.joints);
  JointSample sample;
  auto found = JointMatching::Found::kNone;
  while (found == JointMatching::Found::kNone && source.next(sample)) {
    found = matching.match(*sample.names);
  }
  source.rewind();
  const bool filled = sample.position.size > 0 && sample.velocity.size > 0 &&
                      (sample.effort.size > 0 || !options.effort_required);
  return found == JointMatching::Found::kRepeated ||
         (found == JointMatching::Found::kAll && filled);
}

}  // namespace

std::string name(Storage storage) { return storage == Storage::kMcap ? "mcap" : "sqlite3"; }

RecordingContent::RecordingContent(std::string given_path) : path(std::move(given_path)) {
  readable(path, [this] { read(); });
}

void RecordingContent::read() {
  const Place place = placeOf(path);
  if (place == Place::kDirectory) {
    static_cast<Metadata&>(*this) = readMetadata(path + "/metadata.yaml");
    sortParts(files);
    for (std::string& file : files) file = path + "/" + file;
    requireFiles(files);
    return;
  }
  files = place == Place::kParts ? partsIn(path) : std::vector<std::string>{path};
  storage = storageOf(files.front());
  if (place == Place::kParts) {
    note = "metadata.yaml is missing: " + counted(static_cast<std::int64_t>(files.size()), "file") +
           " found in " + path + " read in the order of their numbers";
    requireFiles(files);
  } else {
    note = partNote(path);
  }
  for (const std::string& file : files) {
    const auto reader = open(file);
    reader->countMessages();
    for (const Connection& there : reader->connections()) connections.push_back(there);
  }
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
  const std::vector<std::string> parts = partsOf(*content_, topic);
  if (type == kJointState && parts.size() > 1) {
    for (const std::string& part : parts) topicOfType(type, part);
    return topic;
  }
  if (there.empty()) {
    throw RecordingError(where + ": is an empty recording: it has no topic; record it again");
  }
  if (topic.empty()) {
    if (!filled.empty()) candidates = std::move(filled);
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
  for (const std::string& part : partsOf(*content_, topic)) {
    for (const Connection& connection : content_->connections) {
      if (connection.topic == part) messages += connection.messages;
    }
  }
  return messages;
}

std::unique_ptr<MessageSource> Recording::messages(const std::string& topic) const {
  return std::make_unique<Messages>(content_, topic);
}

std::unique_ptr<MessageSource> Recording::allMessages() const {
  return std::make_unique<Messages>(content_, "");
}

std::unique_ptr<JointStateSource> Recording::jointStates(const std::string& topic) const {
  const std::string chosen = topicOfType(kJointState, topic);
  return std::make_unique<JointStates>(messages(chosen), path() + ": " + chosen,
                                       expectedMessages(chosen), content_->note);
}

std::unique_ptr<JointStateSource> Recording::jointStates(const std::string& topic,
                                                         const RecordingOptions& options) const {
  const std::string chosen = topicOfType(kJointState, topic);
  const std::vector<std::string> topics = partsOf(*content_, chosen);
  const auto open = [this](const std::string& one) { return jointStates(one); };
  if (topics.size() == 1) {
    auto source = jointStates(chosen);
    if (startsWithAll(*source, options)) return source;
  }
  Complementary found = complementary(streamsOf(topics, open), options, path());
  if (topics.size() == 1 && !found.missing.empty()) return jointStates(chosen);
  for (const std::string& one : topics) {
    if (found.missing.empty() && found.has(one)) continue;
    throw RecordingError(path() + ": " + chosen + ": expected " +
                         (found.has(one) ? found.missing : "some of the joints on " + one) +
                         ", got none; name other topics with --topic, joined by +");
  }
  return merged(std::move(found.streams), open, options, path());
}

std::string Recording::topicsWithJoints(const std::string& usual,
                                        const RecordingOptions& options) const {
  const auto open = [this](const std::string& one) { return jointStates(one); };
  std::vector<std::string> topics, complete;
  for (const Topic& one : this->topics()) {
    if (one.type == kJointState && one.messages > 0) topics.push_back(one.name);
  }
  if (topics.size() < 2) return usual;
  for (const std::string& one : topics) {
    if (!startsWithAll(*jointStates(one), options)) continue;
    if (one == usual) return usual;
    complete.push_back(one);
  }
  if (!complete.empty()) return complete.size() == 1 ? complete.front() : usual;
  const Complementary found = complementary(streamsOf(topics, open), options, path());
  if (!found.missing.empty()) return usual;
  std::string joined;
  for (const std::string& one : topics) {
    if (found.has(one)) joined += (joined.empty() ? "" : "+") + one;
  }
  return joined;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
