// SPDX-License-Identifier: Apache-2.0

#include "sample_stream.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using Eigen::Index;

void SampleStream::throwChanged() const {
  throw RecordingError(where() + (where().empty() ? "" : ": ") +
                       "expected the same samples each time it is read, got others; is it being "
                       "written, or on a medium that fails? Evaluate again when it is complete");
}

bool SamplesInMemory::next(SampleBlock& block) {
  const Index count = std::min(kSamplesAtOnce, time_.size() - next_);
  if (count == 0) {
    return false;
  }
  const auto columns = [&](const JointLogView::Block& all, Eigen::MatrixXd& part) {
    if (all.size() > 0) {
      part = all.middleCols(next_, count);
    }
  };
  block.first = next_;
  block.time = time_.segment(next_, count);
  if (log_.header_stamps.size() > 0) {
    block.header_stamps = log_.header_stamps.segment(next_, count);
    block.receive_stamps = log_.receive_stamps.segment(next_, count);
  } else {  // stamps for texts
    block.header_stamps = (block.time * 1e9).array().round().cast<std::int64_t>();
    block.receive_stamps = block.header_stamps;
  }
  columns(log_.q, block.q);
  columns(log_.qd, block.qd);
  columns(log_.effort, block.effort);
  columns(log_.qdd, block.qdd);
  next_ += count;
  return true;
}

RecordedSamples::RecordedSamples(JointStateSource& source, std::vector<std::string> joints,
                                 Clock clock, JointLogOptions options)
    : source_(source),
      joints_(std::move(joints)),
      asked_(clock),
      clock_(clock == Clock::kReceive ? clock : Clock::kHeader),
      options_(std::move(options)),
      builder_(source.where(), joints_, options_) {}

bool RecordedSamples::next(SampleBlock& block) {
  const auto waits = [&] { return builder_.samplesToTake(); };
  while (waits() < kSamplesAtOnce && source_.next(messages_)) {
    builder_.add(messages_);
  }
  if (waits() == 0) {
    if (all_ < 0) {
      about_ = builder_.finish(asked_);
      all_ = samples_;
      all_checked_ = checked_;
    } else if (samples_ != all_ || checked_ != all_checked_) {
      throwChanged();
    }
    return false;
  }
  JointLog log = builder_.takeSamples();
  block.first = samples_;
  block.header_stamps = log.header_stamps;
  block.receive_stamps = log.receive_stamps;
  log.clock = clock_;
  if (samples_ == 0) {
    begin_ = log.stamps()[0];
  }
  block.time = secondsSince(begin_, log.stamps());
  block.q = log.q;
  block.qd = log.qd;
  block.effort = log.effort;
  block.qdd = log.qdd;
  samples_ += block.size();
  for (const Eigen::MatrixXd* numbers : {&block.q, &block.qd, &block.effort, &block.qdd}) {
    check(*numbers);
  }
  check(block.time);
  return true;
}

// Takes numbers into the check sum: FNV-1a, 8 bytes at a time, with the upper half mixed into the
// lower one, which a product alone leaves as it is.
void RecordedSamples::check(const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  for (Index i = 0; i < numbers.size(); ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, numbers.data() + i, sizeof bits);
    checked_ = (checked_ ^ bits) * kPrime;
    checked_ ^= checked_ >> 32U;
  }
}

void RecordedSamples::rewind() {
  source_.rewind();
  builder_ = JointLogBuilder(source_.where(), joints_, options_);
  samples_ = 0;
  checked_ = 0;
}

bool RecordedSamples::clockHasChanged() {
  if (clock_ == about_.clock) {
    return false;
  }
  clock_ = about_.clock;
  all_ = -1;
  return true;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
