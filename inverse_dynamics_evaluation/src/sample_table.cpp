// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/sample_table.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <new>
#include <system_error>
#include <utility>

#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr Index kReadAtOnce = 4096;  // samples that a JointLogBuilder collects for the table

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

void SampleTable::append(const JointLogView& samples) {
  const Index before = size(), count = samples.q.cols();
  const auto put = [&](auto& columns, const auto& more) {
    place(columns, more.rows(), before + count);
    columns.rightCols(count) = more;
  };
  const auto put_stamps = [&](StampColumn& column, const JointLogView::StampsBlock& more) {
    place(column, before + count, 1);
    column.tail(count) = more;
  };
  put(q, samples.q);
  put(qd, samples.qd);
  if (samples.effort.size() > 0) put(effort, samples.effort);
  has_accelerations = samples.qdd.size() > 0;
  if (has_accelerations) put(qdd, samples.qdd);
  put_stamps(header_stamps, samples.header_stamps);
  put_stamps(receive_stamps, samples.receive_stamps);
}

void SampleTable::complete(Clock clock) {
  clock_ = clock;
  const Index count = size(), joints = q.rows();
  place(time, count, 1);
  for (Index k = 0; k < count; ++k) {
    time[k] = 1e-9 * nanosecondsBetween(stamps()[0], stamps()[k]);
  }
  if (!has_accelerations) place(qdd, joints, count);
  place(computed, joints, count);
  place(measured, effort.rows(), effort.cols());
  place(instant, count, 1);
  for (FlagColumn* flags :
       {&repeated, &non_increasing, &start_transient, &isolated, &used, &kept}) {
    place(*flags, count, 1);
  }
}

SampleTable::JointColumns SampleTable::scratch(Index rows, Index cols) {
  place(scratch_, rows, cols);
  return scratch_;
}

namespace {

// The messages of a recording between two times.
class Window {
 public:
  Window(JointStateSource& source, const RecordingOptions& options)
      : source_(source), span_(options.window), clock_(options.clock) {
    if (bounded()) findStart(JointMatching(options.joints));
  }

  /// The message behind the last one, from `begin` on, that is on the same side as that message.
  std::size_t endOfRun(const JointStateBlock& block, std::size_t begin, bool& inside) {
    if (!has_start_) {
      inside = true;
      return block.size();
    }
    inside = holds(block, begin);
    found_ = found_ || inside;
    std::size_t end = begin + 1;
    while (end < block.size() && holds(block, end) == inside) ++end;
    return end;
  }

  /// All messages were looked at. @throws RecordingError: none lies in the window.
  void requireAny() const {
    if (!has_start_ || found_) return;
    const auto seconds = [](double time) { return formatted("%.9g", time) + " s"; };
    std::string asked;
    if (std::isfinite(span_.from)) asked += " from " + seconds(span_.from);
    if (std::isfinite(span_.to)) asked += " to " + seconds(span_.to);
    throw RecordingError(source_.where() + ": expected samples" + asked +
                         " after the first one, got none: those of the recording go from " +
                         seconds(1e-9 * least_) + " to " + seconds(1e-9 * greatest_) +
                         "; choose --from and --to in between");
  }

 private:
  bool bounded() const { return std::isfinite(span_.from) || std::isfinite(span_.to); }

  // The clock, and the stamp of the first sample: a recording without headers is read to its end.
  void findStart(JointMatching joints) {
    std::int64_t header = 0, receive = 0;
    bool stamped = false;
    JointStateBlock block;
    while (!(has_start_ && (stamped || clock_ != Clock::kAuto)) && source_.next(block)) {
      if (!joints.joints().empty() &&
          joints.match(block.joint_names) == JointMatching::Found::kNone) {
        continue;
      }
      if (!std::exchange(has_start_, true)) {
        header = block.header_stamps.front();
        receive = block.receive_stamps.front();
      }
      stamped = stamped || std::any_of(block.header_stamps.begin(), block.header_stamps.end(),
                                       [](std::int64_t stamp) { return stamp != 0; });
    }
    if (clock_ == Clock::kAuto) clock_ = stamped ? Clock::kHeader : Clock::kReceive;
    start_ = clock_ == Clock::kHeader ? header : receive;
    source_.rewind();
  }

  bool holds(const JointStateBlock& block, std::size_t i) {
    const auto& stamps = clock_ == Clock::kReceive ? block.receive_stamps : block.header_stamps;
    const double time = nanosecondsBetween(start_, stamps[i]);
    least_ = std::min(least_, time);
    greatest_ = std::max(greatest_, time);
    return std::round(1e9 * span_.from) <= time && time <= std::round(1e9 * span_.to);
  }

  JointStateSource& source_;
  TimeSpan span_;
  Clock clock_;
  bool has_start_ = false;           // else all messages are in the window
  std::int64_t start_ = 0;           // ns; stamp of the first sample
  bool found_ = false;               // a message in the window
  double least_ = 0, greatest_ = 0;  // ns since the first sample
};

}  // namespace

JointLog readTable(JointStateSource& source, const RecordingOptions& options, SampleTable& table,
                   const TellProgress& progress) {
  JointLogBuilder builder(source.where(), options.joints, options.log);
  Window window(source, options);
  const auto expected = std::max(static_cast<double>(source.expectedMessages()), 1.0);
  double read = 0;
  JointStateBlock block;
  while (source.next(block)) {
    bool inside = false;
    for (std::size_t begin = 0, end = 0; begin < block.size(); begin = end) {
      end = window.endOfRun(block, begin, inside);
      if (inside) builder.add(block, begin, end);
    }
    if (builder.samplesToTake() >= kReadAtOnce) table.append(builder.takeSamples());
    read += static_cast<double>(block.size());
    if (progress) progress(std::min(read / expected, 1.0));
  }
  window.requireAny();
  if (builder.samplesToTake() > 0) table.append(builder.takeSamples());
  JointLog about = builder.finish(options.clock);
  table.complete(about.clock);
  return about;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
