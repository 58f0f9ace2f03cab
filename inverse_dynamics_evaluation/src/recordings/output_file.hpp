// SPDX-License-Identifier: Apache-2.0
/// @file
/// A new file.
#pragma once

#include <cstdint>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A file that is written from its beginning to its end. Its errors are std::system_error.
class OutputFile {
 public:
  /// The file must not exist.
  explicit OutputFile(const std::string& path);
  /// A file that is open already, and empty.
  explicit OutputFile(int descriptor) : file_(descriptor) {}
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t size);

  /// How many bytes were written.
  std::uint64_t size() const { return size_; }

  void close();

 private:
  int file_;
  std::uint64_t size_ = 0;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
