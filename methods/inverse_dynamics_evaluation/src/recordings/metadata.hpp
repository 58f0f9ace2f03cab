// SPDX-License-Identifier: Apache-2.0
/// @file
/// metadata.yaml of a recording: all versions are read, 9 is written.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_evaluation/recording.hpp"
#include "storage_reader.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What is compressed (zstd).
enum class Compression { kNone, kFiles, kMessages };

/// What the file states, as far as reading needs it.
struct Metadata {
  Storage storage = Storage::kSqlite3;
  Compression compression = Compression::kNone;
  std::vector<std::string> files;  ///< names in the directory
  std::vector<Connection> connections;
};

/// @throws DamageError, ReadingError, and YAML::Exception where it isn't YAML.
Metadata readMetadata(const std::string& path);

/// Times and numbers of a recording of joint states in one file.
struct MetadataSummary {
  Storage storage = Storage::kSqlite3;
  std::string file;                 ///< its name
  std::int64_t start = 0, end = 0;  ///< ns; first and last time of reception
  std::vector<std::pair<std::string, std::int64_t>> topics;  ///< names and numbers of messages
};

/// The text of metadata.yaml; nested: without the outermost key, as stored in the files themselves.
std::string metadataText(const MetadataSummary& summary, bool nested);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
