// SPDX-License-Identifier: Apache-2.0

#include "output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category()); }

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (file_ < 0) fail();
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
}

void OutputFile::write(const void* data, std::size_t size) {
  const auto* at = static_cast<const std::uint8_t*>(data);
  for (const std::uint8_t* const end = at + size; at < end;) {
    const ssize_t written = ::write(file_, at, static_cast<std::size_t>(end - at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    at += written;
  }
  size_ += size;
}

void OutputFile::close() {
  const int file = file_;
  file_ = -1;
  if (::close(file) != 0) fail();
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
