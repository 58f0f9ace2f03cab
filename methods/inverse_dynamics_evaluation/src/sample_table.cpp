// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/sample_table.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

[[noreturn]] void throwCannotWrite(const std::string& directory, int error) {
  throw RecordingError(directory + ": can't be written (" + std::generic_category().message(error) +
                       "); free some space, or name another output with --out");
}

// A file that has no name.
int openFile(const std::string& directory) {
  int file = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) {  // a file system that has no such files
    std::string name = directory + "/.samples-XXXXXX";
    file = mkostemp(name.data(), O_CLOEXEC);
    if (file >= 0) unlink(name.c_str());
  }
  if (file < 0) throwCannotWrite(directory, errno);
  return file;
}

}  // namespace

std::string name(Clock clock) {
  return clock == Clock::kHeader ? "header" : clock == Clock::kReceive ? "receive" : "auto";
}

double nanosecondsBetween(std::int64_t from, std::int64_t to) {
  const auto distance = [](std::int64_t less, std::int64_t more) {
    return static_cast<double>(static_cast<std::uint64_t>(more) - static_cast<std::uint64_t>(less));
  };
  return from <= to ? distance(from, to) : -distance(to, from);
}

// Memory that grows and keeps what it holds: anonymous, or a mapped file.
class SampleTable::Memory {
 public:
  explicit Memory(const std::string& directory)
      : directory_(directory), file_(directory.empty() ? -1 : openFile(directory)) {}
  ~Memory() {
    if (data_ != nullptr) munmap(data_, capacity_);
    if (file_ >= 0) close(file_);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  /// At least so many bytes.
  void* reserve(std::size_t bytes) {
    if (bytes > capacity_) {
      // an eighth more than there was, so that a long recording grows seldom and wastes little
      const std::size_t wanted = std::max(bytes, capacity_ + capacity_ / 8);
      grow((wanted + kPage - 1) / kPage * kPage);
    }
    return data_;
  }

 private:
  static constexpr std::size_t kPage = 65536;  // bytes; a multiple of any system's page

  void grow(std::size_t capacity) {
    if (file_ >= 0) {
      // a full disk is an error here, and not a signal when a page is written
      int error = EINTR;
      while (error == EINTR) {
        error = posix_fallocate(file_, static_cast<off_t>(capacity_),
                                static_cast<off_t>(capacity - capacity_));
      }
      if (error != 0) throwCannotWrite(directory_, error);
    }
    const int flags = file_ >= 0 ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS;
    void* const data = data_ == nullptr
                           ? mmap(nullptr, capacity, PROT_READ | PROT_WRITE, flags, file_, 0)
                           : mremap(data_, capacity_, capacity, MREMAP_MAYMOVE);
    if (data == MAP_FAILED) throw std::bad_alloc();
    if (file_ >= 0) {
      // pages of files in one go: each by itself takes a microsecond. A kernel before 5.14 can't
      madvise(static_cast<char*>(data) + capacity_, capacity - capacity_, MADV_POPULATE_WRITE);
    }
    data_ = data;
    capacity_ = capacity;
  }

  const std::string& directory_;
  int file_;
  void* data_ = nullptr;
  std::size_t capacity_ = 0;
};

SampleTable::SampleTable(std::string directory) : directory_(std::move(directory)) {}

SampleTable::~SampleTable() = default;

// Gives columns a size; their first rows stay.
template <class Columns>
void SampleTable::place(Columns& columns, Index rows, Index cols) {
  if (rows * cols == 0) return;
  auto found = std::find_if(memory_.begin(), memory_.end(),
                            [&](const auto& each) { return each.first == &columns; });
  if (found == memory_.end()) {
    memory_.emplace_back(&columns, std::make_unique<Memory>(directory_));
    found = memory_.end() - 1;
  }
  using Scalar = typename Columns::Scalar;
  const auto bytes = static_cast<std::size_t>(rows * cols) * sizeof(Scalar);
  // Eigen's way of making a map look elsewhere
  new (&columns) Columns(static_cast<Scalar*>(found->second->reserve(bytes)), rows, cols);
}

void SampleTable::resize(Index joints, Index samples, Recorded recorded) {
  place(q, joints, samples);
  place(qd, joints, samples);
  if (recorded.efforts) place(effort, joints, samples);
  has_accelerations = recorded.accelerations;
  if (has_accelerations) place(qdd, joints, samples);
  place(header_stamps, samples, 1);
  place(receive_stamps, samples, 1);
}

void SampleTable::complete(Clock clock) {
  clock_ = clock;
  const Index count = size(), joints = q.rows();
  place(time, count, 1);
  for (Index k = 0; k < count; ++k) time[k] = 1e-9 * nanosecondsBetween(stamps()[0], stamps()[k]);
  if (!has_accelerations) place(qdd, joints, count);
  place(computed, joints, count);
  place(measured, effort.rows(), effort.cols());
  place(instant, count, 1);
  for (FlagColumn* flags :
       {&repeated, &non_increasing, &start_transient, &isolated, &used, &kept}) {
    place(*flags, count, 1);
  }
}

RecordedColumns SampleTable::recorded() const {
  return {header_stamps,
          receive_stamps,
          clock_,
          q,
          qd,
          effort,
          has_accelerations ? qdd : JointColumns(nullptr, 0, 0)};
}

std::unique_ptr<SampleTable> tableOf(const RecordedColumns& columns) {
  auto table = std::make_unique<SampleTable>();
  table->resize(columns.q.rows(), columns.q.cols(),
                {columns.effort.size() > 0, columns.qdd.size() > 0});
  table->header_stamps = columns.header_stamps;
  table->receive_stamps = columns.receive_stamps;
  table->q = columns.q;
  table->qd = columns.qd;
  if (columns.effort.size() > 0) table->effort = columns.effort;
  if (columns.qdd.size() > 0) table->qdd = columns.qdd;
  table->complete(columns.clock);
  return table;
}

std::unique_ptr<SampleTable> tableOf(const Eigen::Ref<const Eigen::VectorXd>& time,
                                     const Eigen::Ref<const Eigen::MatrixXd>& q,
                                     const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                     const Eigen::Ref<const Eigen::MatrixXd>& effort) {
  checkSamples(time, q, qd, effort);
  const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> stamps =
      (time * 1e9).array().round().cast<std::int64_t>();  // for texts
  auto table = tableOf({stamps, stamps, Clock::kHeader, q, qd, effort, Eigen::MatrixXd()});
  table->time = time;
  return table;
}

SampleTable::JointColumns SampleTable::scratch(Index rows, Index cols) {
  place(scratch_, rows, cols);
  return scratch_;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
