// SPDX-License-Identifier: Apache-2.0

#include "bytes.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

InputFile::InputFile(const std::string& path)
    : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat about {};
  if (file_ < 0 || ::fstat(file_, &about) != 0) {
    const std::string reason = std::generic_category().message(errno);
    if (file_ >= 0) ::close(file_);
    throw ReadingError("can't open " + quoted(path) + ": " + reason + "; make it readable");
  }
  if (!S_ISREG(about.st_mode)) {
    ::close(file_);
    throw DamageError(quoted(path) + " is not a file");
  }
  size_ = static_cast<std::uint64_t>(about.st_size);
}

InputFile::~InputFile() { ::close(file_); }

void InputFile::read(std::uint64_t offset, std::uint64_t size, Bytes& out) const {
  if (offset > size_ || size > size_ - offset) {
    throw DamageError("expected " + std::to_string(size) + " bytes at offset " +
                      std::to_string(offset) + ", got the end of the file");
  }
  out.resize(size);
  for (std::size_t done = 0; done < size;) {
    const ssize_t got =
        ::pread(file_, out.data() + done, size - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw ReadingError("can't be read: " + std::generic_category().message(errno) +
                         "; copy it to another disk");
    }
    if (got == 0) throw DamageError("the file became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
}

namespace {

[[noreturn]] void throwSystemError() { throw std::system_error(errno, std::generic_category()); }

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (file_ < 0) throwSystemError();
}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
}

void OutputFile::write(const void* data, std::size_t size) {
  const auto* at = static_cast<const std::uint8_t*>(data);
  for (const std::uint8_t* const end = at + size; at < end;) {
    const ssize_t written = ::write(file_, at, static_cast<std::size_t>(end - at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throwSystemError();
    at += written;
  }
  size_ += size;
}

void OutputFile::close() {
  const int file = file_;
  file_ = -1;
  if (::close(file) != 0) throwSystemError();
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
