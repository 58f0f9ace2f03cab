// SPDX-License-Identifier: Apache-2.0
/// @file
/// The file of a new recording, in either kind of storage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/recording.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// As `ros2 interface show` has it, without comments: a part per type.
inline constexpr char kJointStateDefinition[] =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
    "float64[] effort\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

inline constexpr char kJointStateHash[] =
    "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";

/// A file that is being written. Its errors are std::runtime_error with the reason alone.
class StorageWriter {
 public:
  StorageWriter() = default;
  StorageWriter(const StorageWriter&) = delete;
  StorageWriter& operator=(const StorageWriter&) = delete;
  virtual ~StorageWriter() = default;

  /// Appends a message of a topic, whose number is counted from 0.
  virtual void write(std::size_t topic, std::int64_t received, const std::uint8_t* data,
                     std::size_t size) = 0;

  /// Writes indexes and the text of metadata.yaml, and closes the file.
  virtual void finish(const std::string& metadata) = 0;
};

/// A new file of topics of joint states.
std::unique_ptr<StorageWriter> createSqlite(const std::string& path,
                                            const std::vector<std::string>& topics);
std::unique_ptr<StorageWriter> createMcap(const std::string& path,
                                          const std::vector<std::string>& topics);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
