// SPDX-License-Identifier: Apache-2.0
/// @file
/// The file of a new recording, in either kind of storage.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A file that is being written. Its errors are std::runtime_error with the reason alone.
class StorageWriter {
 public:
  StorageWriter() = default;
  StorageWriter(const StorageWriter&) = delete;
  StorageWriter& operator=(const StorageWriter&) = delete;
  virtual ~StorageWriter() = default;

  /// Appends a message of a connection, whose number is counted from 0.
  virtual void write(std::size_t connection, std::int64_t received, const std::uint8_t* data,
                     std::size_t size) = 0;

  /// Writes indexes and the text of metadata.yaml, and closes the file.
  virtual void finish(const std::string& metadata) = 0;
};

/// All connections must be of one type, whose definition they hold.
std::unique_ptr<StorageWriter> createSqlite(const std::string& path,
                                            const std::vector<Connection>& connections);
std::unique_ptr<StorageWriter> createMcap(const std::string& path,
                                          const std::vector<Connection>& connections);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
