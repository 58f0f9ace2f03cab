// SPDX-License-Identifier: Apache-2.0

#include "metadata.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "bytes.hpp"
#include "storage_writer.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

YAML::Node required(const YAML::Node& node, const char* key) {
  if (!node.IsMap()) {
    throw DamageError(std::string("metadata.yaml: ") + key + ": expected it in a mapping");
  }
  const YAML::Node found = node[key];
  if (!found) throw DamageError(std::string("metadata.yaml: the key ") + key + " is missing");
  return found;
}

std::string shown(const YAML::Node& node) {
  return node.IsScalar() ? quoted(node.Scalar()) : node.IsNull() ? "nothing" : "a list or mapping";
}

std::int64_t integer(const YAML::Node& node, const char* key) {
  const YAML::Node found = required(node, key);
  std::int64_t number = 0;
  if (!found.IsScalar() || found.Tag() == "!" ||
      !YAML::convert<std::int64_t>::decode(found, number)) {
    throw DamageError(std::string("metadata.yaml: ") + key + ": expected a whole number, got " +
                      shown(found));
  }
  return number;
}

// Whether YAML takes a scalar without quotes for a text.
bool isText(const YAML::Node& node) {
  if (!node.IsScalar()) return false;
  double number = 0;
  bool truth = false;
  return node.Tag() == "!" ||
         !(YAML::convert<double>::decode(node, number) || YAML::convert<bool>::decode(node, truth));
}

std::string text(const YAML::Node& node, const char* key) {
  if (!isText(node)) {
    throw DamageError(std::string("metadata.yaml: ") + key + ": expected a text, got " +
                      shown(node));
  }
  return node.Scalar();
}

// A text that may be absent, or nothing.
std::string optionalText(const YAML::Node& node, const char* key) {
  const YAML::Node found = node[key];
  return !found || found.IsNull() ? "" : text(found, key);
}

// What YAML calls printable, in UTF-8.
std::string contentOf(const std::string& path) {
  constexpr std::uint64_t kLargest = 64'000'000;
  const InputFile file(path);
  if (file.size() > kLargest) {
    throw DamageError("metadata.yaml: expected at most 64 MB, got " + std::to_string(file.size()) +
                      " bytes");
  }
  Bytes bytes;
  file.read(0, file.size(), bytes);
  std::string content(bytes.begin(), bytes.end());
  requireUtf8(content, "metadata.yaml");
  const auto strange = std::find_if(content.begin(), content.end(), [](char letter) {
    return static_cast<unsigned char>(letter) < 0x20 && letter != '\n' && letter != '\r' &&
           letter != '\t';
  });
  if (strange != content.end()) {
    throw DamageError("metadata.yaml: expected a text, got control characters");
  }
  return content;
}

Connection connectionOf(const YAML::Node& node) {
  const YAML::Node about = required(node, "topic_metadata");
  Connection connection;
  connection.topic = text(required(about, "name"), "name");
  connection.type = text(required(about, "type"), "type");
  connection.serialization = text(required(about, "serialization_format"), "serialization_format");
  connection.messages = integer(node, "message_count");
  if (connection.messages < 0) {
    throw DamageError("metadata.yaml: message_count: expected a number of messages, got " +
                      std::to_string(connection.messages));
  }
  return connection;
}

Compression compressionOf(const YAML::Node& about) {
  std::string mode = optionalText(about, "compression_mode");
  std::transform(mode.begin(), mode.end(), mode.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  if (mode.empty() || mode == "none") return Compression::kNone;
  const std::string format = optionalText(about, "compression_format");
  if (format != "zstd") {
    throw DamageError("compression format: expected zstd, got " + quoted(format));
  }
  if (mode == "file") return Compression::kFiles;
  if (mode == "message") return Compression::kMessages;
  throw DamageError("compression mode: expected file or message, got " +
                    inverse_dynamics_evaluation::quoted(mode));
}

// As YAML has it within a line: in quotes unless it consists of letters, digits and a few signs.
std::string scalar(const std::string& value) {
  const bool plain =
      !value.empty() &&
      (std::isalpha(static_cast<unsigned char>(value[0])) != 0 || value[0] == '/') &&
      std::all_of(value.begin(), value.end(), [](unsigned char letter) {
        return std::isalnum(letter) != 0 || letter == '/' || letter == '_' || letter == '.';
      });
  if (plain) return value;
  std::string quotes = "\"";
  for (const char letter : value) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x20 || code == 0x7f) {
      constexpr char kDigits[] = "0123456789abcdef";
      quotes += {'\\', 'x', kDigits[code >> 4U], kDigits[code & 15U]};
    } else {
      if (letter == '"' || letter == '\\') quotes += '\\';
      quotes += letter;
    }
  }
  return quotes + "\"";
}

}  // namespace

Metadata readMetadata(const std::string& path) {
  const YAML::Node root = YAML::Load(contentOf(path));
  const YAML::Node about = required(root, "rosbag2_bagfile_information");
  integer(about, "version");  // newer ones add keys
  Metadata metadata;
  const std::string storage = text(required(about, "storage_identifier"), "storage_identifier");
  if (storage != name(Storage::kSqlite3) && storage != name(Storage::kMcap)) {
    throw DamageError("storage: expected sqlite3 or mcap, got " + quoted(storage));
  }
  metadata.storage = storage == name(Storage::kMcap) ? Storage::kMcap : Storage::kSqlite3;
  metadata.compression = compressionOf(about);
  const YAML::Node files = required(about, "relative_file_paths");
  const YAML::Node topics = required(about, "topics_with_message_count");
  if (!files.IsSequence() || !topics.IsSequence()) {
    throw DamageError(
        "metadata.yaml: relative_file_paths, topics_with_message_count: expected lists");
  }
  for (const auto& file : files) {
    const std::string whole = text(file, "relative_file_paths");
    metadata.files.push_back(whole.substr(whole.find_last_of('/') + 1));  // npos + 1 is 0
  }
  for (const auto& topic : topics) metadata.connections.push_back(connectionOf(topic));
  integer(about, "message_count");
  integer(required(about, "duration"), "nanoseconds");
  integer(required(about, "starting_time"), "nanoseconds_since_epoch");
  return metadata;
}

std::string metadataText(const MetadataSummary& summary, bool nested) {
  std::int64_t messages = 0;
  std::string topics;
  for (const auto& [topic, count] : summary.topics) {
    messages += count;
    topics +=
        "\n- message_count: " + std::to_string(count) +
        "\n  topic_metadata:\n    name: " + scalar(topic) +
        "\n    offered_qos_profiles: []\n    serialization_format: cdr\n    type: " + kJointState +
        "\n    type_description_hash: " + kJointStateHash;
  }
  const std::string count = std::to_string(messages);
  const std::string file = scalar(summary.file);
  const std::string start =
      std::to_string(messages > 0 ? summary.start : std::numeric_limits<std::int64_t>::max());
  const std::string duration = std::to_string(messages > 0 ? summary.end - summary.start : 0);
  std::string text = "compression_format: ''\ncompression_mode: ''\ncustom_data: null\n";
  text += "duration:\n  nanoseconds: " + duration + "\n";
  text += "files:\n- duration:\n    nanoseconds: " + duration + "\n  message_count: " + count +
          "\n  path: " + file + "\n  starting_time:\n    nanoseconds_since_epoch: " + start + "\n";
  text += "message_count: " + count + "\nrelative_file_paths:\n- " + file;
  text += "\nros_distro: unknown\nstarting_time:\n  nanoseconds_since_epoch: " + start + "\n";
  text += "storage_identifier: " + name(summary.storage);
  text += "\ntopics_with_message_count:" + (topics.empty() ? " []" : topics) + "\nversion: 9";
  if (!nested) {
    for (std::size_t at = 0; at != std::string::npos; at = text.find('\n', at + 3)) {
      text.insert(at == 0 ? 0 : at + 1, "  ");
    }
    text = "rosbag2_bagfile_information:\n" + text + "\n";
  }
  return text;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
