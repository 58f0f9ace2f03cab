// SPDX-License-Identifier: Apache-2.0

#include "spooled_samples.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// Sizes of a block in the file: samples, joints, of efforts, of accelerations.
using Sizes = std::array<std::int64_t, 4>;

[[noreturn]] void throwCannotWrite(const std::string& directory, int error) {
  throw RecordingError(directory + ": can't be written (" + std::generic_category().message(error) +
                       "); free some space, or name another output with --out");
}

[[noreturn]] void throwCannotRead(const std::string& directory, int error) {
  throw RecordingError(directory + ": the samples written there can't be read again (" +
                       std::generic_category().message(error) +
                       "); is the disk failing? Name an output on another one with --out");
}

// A file that has no name.
int openFile(const std::string& directory) {
  int file = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) {  // a file system that has no such files
    std::string name = directory + "/.samples-XXXXXX";
    file = mkostemp(name.data(), O_CLOEXEC);
    if (file >= 0) {
      unlink(name.c_str());
    }
  }
  if (file < 0) {
    throwCannotWrite(directory, errno);
  }
  return file;
}

}  // namespace

SpooledSamples::SpooledSamples(SampleStream& samples, std::string directory)
    : samples_(samples), directory_(std::move(directory)), file_(openFile(directory_)) {}

SpooledSamples::~SpooledSamples() { close(file_); }

bool SpooledSamples::next(SampleBlock& block) {
  if (complete_) {
    if (place_ == size_) {
      return false;
    }
    transfer(false, block);
    return true;
  }
  if (!samples_.next(block)) {
    complete_ = true;
    size_ = place_;
    return false;
  }
  transfer(true, block);
  return true;
}

void SpooledSamples::rewind() {
  place_ = 0;
  first_ = 0;
  if (!complete_) {
    samples_.rewind();
  }
}

bool SpooledSamples::clockHasChanged() {
  complete_ = !samples_.clockHasChanged();  // else times are others: they are written again
  return !complete_;
}

// Writes or reads a block.
void SpooledSamples::transfer(bool out, SampleBlock& block) {
  Sizes sizes = {block.size(), block.q.rows(), block.effort.rows(), block.qdd.rows()};
  transfer(out, sizes.data(), sizeof sizes);
  const std::int64_t count = sizes[0];
  const auto numbers = [&](auto& series, std::int64_t rows) {
    series.resize(rows, rows > 0 ? count : 0);
    transfer(out, series.data(), 8 * series.size());
  };
  const auto vector = [&](auto& series) {
    series.resize(count);
    transfer(out, series.data(), 8 * count);
  };
  block.first = first_;
  vector(block.header_stamps);
  vector(block.receive_stamps);
  vector(block.time);
  numbers(block.q, sizes[1]);
  numbers(block.qd, sizes[1]);
  numbers(block.effort, sizes[2]);
  numbers(block.qdd, sizes[3]);
  first_ += count;
}

// Writes or reads what is next in the file.
void SpooledSamples::transfer(bool out, void* data, std::int64_t bytes) {
  auto* next = static_cast<char*>(data);
  while (bytes > 0) {
    const auto size = static_cast<std::size_t>(bytes);
    const ssize_t done = out ? pwrite(file_, next, size, place_) : pread(file_, next, size, place_);
    if (done < 0 && errno == EINTR) {
      continue;
    }
    if (done <= 0) {
      (out ? throwCannotWrite : throwCannotRead)(directory_, done < 0 ? errno : EIO);
    }
    next += done;
    place_ += done;
    bytes -= done;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
