// SPDX-License-Identifier: Apache-2.0

/// @file
/// A recording that is written whole or not at all, and never over something else.

#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <rclcpp/time.hpp>
#include <rosbag2_cpp/writer.hpp>
#include <string>

namespace inverse_dynamics_ros {

/// Writes into a hidden directory beside the target, which takes the target's name at the end.
class OutputBag {
 public:
  /// For a recording that another writer puts at path().
  ///
  /// @throws UserError: the target exists, or can't be written.
  explicit OutputBag(const std::filesystem::path& target);

  /// For messages of any type. @param storage  sqlite3 or mcap. @throws UserError: likewise.
  OutputBag(const std::filesystem::path& target, const std::string& storage);

  /// Removes what was written, unless finish() was called.
  ~OutputBag();
  OutputBag(const OutputBag&) = delete;
  OutputBag& operator=(const OutputBag&) = delete;

  /// Where the recording is until it is finished.
  std::filesystem::path path() const { return work_ / target_.filename(); }

  /// @param stamp  ns; when the message was received.
  template <class Message>
  void write(const Message& message, const std::string& topic, std::int64_t stamp) {
    writer_->write(message, topic, rclcpp::Time(stamp));
  }

  /// Closes the recording and gives it its name. @throws UserError: it can't be.
  void finish();

  /// @throws UserError: there is something of that name, or no name.
  static void requireFree(const std::filesystem::path& target);

 private:
  std::filesystem::path target_;
  std::filesystem::path work_;  // holds the recording, under its own name, until it is finished
  std::unique_ptr<rosbag2_cpp::Writer> writer_;
};

}  // namespace inverse_dynamics_ros
