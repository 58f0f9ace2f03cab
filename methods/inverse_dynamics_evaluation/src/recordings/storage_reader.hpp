// SPDX-License-Identifier: Apache-2.0
/// @file
/// One file of a recording, in either kind of storage.
#pragma once

#include <cstdint>
#include <limits>
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

/// Whether the recorder's clock was set back, by times of reception in the order of storage.
///
/// Then that order is the right one: by time, messages from before and after would alternate. Times that fall
/// back often belong to messages that a tool has stored in another order.
class StoredTimes {
 public:
  void add(std::int64_t time) {
    if (time < previous_ && distance(time, previous_) > kLeast) ++steps_;
    ++count_;
    previous_ = time;
  }

  bool showStep() const { return steps_ > 0 && kMessages * steps_ <= count_; }

 private:
  static constexpr std::uint64_t kLeast =
      20'000'000;                                // ns; messages that arrive together differ by less
  static constexpr std::int64_t kMessages = 20;  // at least, per step

  // Of two times, of which the earlier is the first: it may be more than a signed number holds.
  static std::uint64_t distance(std::int64_t from, std::int64_t to) {
    return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  }

  std::int64_t previous_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t count_ = 0, steps_ = 0;
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

  /// The next message of these, in the order of reception, but in that of storage where the recorder's clock
  /// was set back (StoredTimes); false after the last one.
  virtual bool next(Message& message) = 0;

 protected:
  std::vector<Connection> connections_;
};

std::unique_ptr<StorageReader> openSqlite(const std::string& path);
std::unique_ptr<StorageReader> openMcap(const std::string& path);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
