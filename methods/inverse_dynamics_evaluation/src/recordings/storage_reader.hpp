// SPDX-License-Identifier: Apache-2.0
/// @file
/// One file of a recording, in either kind of storage.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What a file states about the messages of one publisher.
struct Connection {
  std::string topic;
  std::string type;           ///< such as `sensor_msgs/msg/JointState`
  std::string serialization;  ///< `cdr`
  std::int64_t messages = 0;  ///< how many
};

/// A file that is open. Its errors are DamageError, ReadingError and SqliteError.
class StorageReader {
 public:
  StorageReader() = default;
  StorageReader(const StorageReader&) = delete;
  StorageReader& operator=(const StorageReader&) = delete;
  virtual ~StorageReader() = default;

  /// What the file states. The numbers of messages are 0 until countMessages().
  const std::vector<Connection>& connections() const { return connections_; }

  /// Fills in the numbers of messages.
  virtual void countMessages() = 0;

  /// Starts before the first message of the connections for which `wanted` is true.
  virtual void select(const std::vector<bool>& wanted) = 0;

  /// The next message of these, in the order of reception; false after the last one.
  virtual bool next(Message& message) = 0;

 protected:
  std::vector<Connection> connections_;
};

std::unique_ptr<StorageReader> openSqlite(const std::string& path);
std::unique_ptr<StorageReader> openMcap(const std::string& path);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
