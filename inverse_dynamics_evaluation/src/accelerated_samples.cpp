// SPDX-License-Identifier: Apache-2.0

#include "accelerated_samples.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "figures.hpp"
#include "spectrum.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Equidistant samples whose spectra are computed at once: longer pieces are cut for that.
constexpr Index kMostInStretch = 262144;

AccelerationMethod methodOf(const AccelerationOptions& options, const Census& census) {
  if (options.method == AccelerationMethod::kAuto) {
    return census.accelerations && options.cutoff == 0 ? AccelerationMethod::kGiven
                                                       : AccelerationMethod::kLowPass;
  }
  if (options.method == AccelerationMethod::kGiven && !census.accelerations) {
    throw EvaluationError(
        "accelerations: the recording gives none; expected another method, such as auto");
  }
  return options.method;
}

void requirePieces(const AccelerationPlan& plan) {
  if (plan.grids.empty()) {
    const SampleCounts& counts = plan.found.report.counts;
    throw EvaluationError(
        "low-pass accelerations", "samples",
        std::to_string(plan.rules.shortest_piece) + " or more that differ, without a gap",
        std::to_string(counts.all - counts.repeated) + " with gaps of more than " +
            std::to_string(plan.rules.longest_gap) + " s between them",
        "record for longer, or take backward differences");
  }
}

// Of the equidistant samples of all pieces [Hz].
double samplingFrequency(const std::vector<Grid>& grids) {
  double intervals = 0.0;
  double duration = 0.0;
  for (const Grid& grid : grids) {
    intervals += static_cast<double>(grid.count - 1);
    duration += static_cast<double>(grid.count - 1) * grid.period;
  }
  return intervals / duration;
}

// Calls `visit` with each used sample of each piece: its grid, the block, its number in the block.
template <class Visit>
void forEachUsed(SampleStream& stream, const AccelerationPlan& plan, Visit visit) {
  TimedSamples samples(stream, plan.found, plan.rules);
  TimedBlock block;
  std::size_t piece = 0;
  while (samples.next(block)) {
    for (Index k = 0; k < block.size(); ++k) {
      if (block.used[k]) {
        while (plan.grids[piece].behind <= block.first + k) {
          ++piece;
        }
        visit(plan.grids[piece], block, k);
      }
    }
  }
}

// Gathers equidistant samples into stretches of bounded length, and adds their spectra.
class StretchSums {
 public:
  StretchSums(SpectrumSums& sums, const Grid& grid, Index joints)
      : sums_(sums),
        joints_(joints),
        count_(grid.count),
        parts_((grid.count + kMostInStretch - 1) / kMostInStretch) {}

  /// The next q and qd.
  void add(const Eigen::Ref<const MatrixXd>& values) {
    for (Index begin = 0; begin < values.cols();) {
      const Index length = (part_ + 1) * count_ / parts_ - part_ * count_ / parts_;
      if (filled_ == 0) {
        stretch_.q.resize(joints_, length);
        stretch_.qd.resize(joints_, length);
      }
      const Index more = std::min(length - filled_, values.cols() - begin);
      stretch_.q.middleCols(filled_, more) = values.block(0, begin, joints_, more);
      stretch_.qd.middleCols(filled_, more) = values.block(joints_, begin, joints_, more);
      begin += more;
      filled_ += more;
      if (filled_ == length) {
        sums_.add(stretch_);
        filled_ = 0;
        ++part_;
      }
    }
  }

 private:
  SpectrumSums& sums_;
  Index joints_, count_, parts_;
  Index part_ = 0, filled_ = 0;
  Stretch stretch_;
};

// A pass over the samples, for the cut-off.
CutoffChoice choiceOf(SampleStream& stream, const AccelerationPlan& plan) {
  const Index joints = plan.census.joints;
  Index longest = 0;
  for (const Grid& grid : plan.grids) {
    longest = std::max(longest, grid.count);
  }
  requireLongEnough(longest);
  const double frequency = plan.filter.sampling_frequency;
  SpectrumSums sums(joints, std::min(longest, kMostInStretch), frequency);
  std::unique_ptr<StretchSums> stretches;
  std::unique_ptr<Resampler> resampler;
  Index first = -1;  // of the piece
  Eigen::VectorXd numbers(2 * joints);
  forEachUsed(stream, plan, [&](const Grid& grid, const TimedBlock& block, Index k) {
    if (grid.first != first) {
      first = grid.first;
      stretches = std::make_unique<StretchSums>(sums, grid, joints);
      resampler = std::make_unique<Resampler>(grid, 2 * joints,
                                              [&](const auto& values) { stretches->add(values); });
    }
    if (resampler->added() == grid.used) {
      stream.throwChanged();
    }
    numbers << block.q.col(k), block.qd.col(k);
    resampler->add(block.instant[k], numbers.data());
  });
  return cutoffOf(sums.spectra(), static_cast<double>(longest - 1) / frequency, frequency,
                  plan.filter.order);
}

void planFilter(SampleStream& stream, const AccelerationOptions& options, AccelerationPlan& plan) {
  for (const Piece& piece : plan.found.pieces) {
    plan.grids.emplace_back(piece, plan.found.usual_period);
  }
  requirePieces(plan);
  FilterChoice& filter = plan.filter;
  filter.method = "zero-phase Butterworth low-pass of the velocities, then central differences";
  filter.order = options.order;
  filter.sampling_frequency = samplingFrequency(plan.grids);
  filter.time_base = plan.found.report.time_base;
  filter.pieces = static_cast<Index>(plan.grids.size());
  filter.cutoff = options.cutoff;
  filter.chosen = options.cutoff == 0;
  if (filter.chosen) {
    filter.choice = choiceOf(stream, plan);
    filter.cutoff = filter.choice.cutoff;
  }
  for (const Grid& grid : plan.grids) {
    requireFilter(1.0 / grid.period, filter.cutoff, filter.order);
  }
}

}  // namespace

void checkCutoff(AccelerationMethod method, double cutoff) {
  const bool filtered =
      method == AccelerationMethod::kAuto || method == AccelerationMethod::kLowPass;
  if (cutoff != 0 && !filtered) {
    throw EvaluationError("accelerations: " + name(method) + " has no cut-off, got " +
                          formatted("%g", cutoff) + " Hz; use low-pass");
  }
  if (!(cutoff >= 0) || std::isinf(cutoff)) {
    throw EvaluationError("low-pass", "cut-off", "above 0 and below half the sampling frequency",
                          formatted("%g", cutoff) + " Hz", "lower it, or don't filter");
  }
}

AccelerationPlan planAccelerations(SampleStream& stream, const AccelerationOptions& options) {
  checkCutoff(options.method, options.cutoff);
  AccelerationPlan plan;
  plan.rules = options.rules;
  plan.census = takeCensus(stream, plan.rules);
  if (stream.clockHasChanged()) {
    plan.census = takeCensus(stream, plan.rules);
  }
  plan.method = methodOf(options, plan.census);
  const bool filtered = plan.method == AccelerationMethod::kLowPass;
  // what the filter needs, every piece must have; without a filter none is too short
  plan.rules.shortest_piece =
      filtered ? std::max(plan.rules.shortest_piece, leastSamples(options.order)) : 1;
  plan.found = examine(stream, plan.census, plan.rules);
  if (filtered) {
    planFilter(stream, options, plan);
  }
  return plan;
}

Interpolation::Interpolation(const std::vector<Grid>& grids, Index joints)
    : grids_(grids), known_(joints, 0) {}

void Interpolation::add(const Eigen::Ref<const MatrixXd>& accelerations) {
  const Index more = accelerations.cols();
  if (count_ + more > known_.cols()) {
    known_.conservativeResize(Eigen::NoChange, std::max(count_ + more, 2 * known_.cols()));
  }
  known_.middleCols(count_, more) = accelerations;
  count_ += more;
}

bool Interpolation::at(double instant, Eigen::Ref<Eigen::VectorXd> acceleration) {
  while (piece_ + 1 < grids_.size() && instant >= grids_[piece_ + 1].begin) {
    piece_first_ += grids_[piece_].count;
    ++piece_;
  }
  const Grid& grid = grids_[piece_];
  const Index last = grid.count - 1;
  const double place = std::max((instant - grid.begin) / grid.period, 0.0);
  Index before = last;
  double share = 0.0;
  if (place < static_cast<double>(last)) {
    before = static_cast<Index>(place);
    share = place - static_cast<double>(before);
  } else if (piece_ + 1 < grids_.size()) {
    const double end = grid.begin + static_cast<double>(last) * grid.period;
    share = std::clamp(
        (place - static_cast<double>(last)) * grid.period / (grids_[piece_ + 1].begin - end), 0.0,
        1.0);
  }
  const bool at_end = before == last && piece_ + 1 == grids_.size();
  const Index here = piece_first_ + before - first_;  // of those that are known
  if (here + (at_end ? 0 : 1) >= count_) {
    return false;
  }
  acceleration = known_.col(here);
  if (!at_end) {
    acceleration = (1.0 - share) * known_.col(here) + share * known_.col(here + 1);
  }
  if (2 * here > known_.cols()) {  // nothing before it will be asked for
    known_.leftCols(count_ - here) = known_.middleCols(here, count_ - here).eval();
    first_ += here;
    count_ -= here;
  }
  return true;
}

AcceleratedSamples::AcceleratedSamples(SampleStream& stream, const AccelerationPlan& plan)
    : stream_(stream),
      plan_(plan),
      samples_(stream, plan.found, plan.rules),
      interpolation_(plan.grids, plan.census.joints) {}

bool AcceleratedSamples::next(TimedBlock& block) {
  while (known_ < kSamplesAtOnce && !ended_) {
    read();
  }
  const Index count = std::min(known_, kSamplesAtOnce);
  if (count == 0) {
    return false;
  }
  block.first = waiting_.front().first + given_;
  resize(block, waiting_.front(), count);
  for (Index at = 0; at < count;) {
    const Index left = waiting_.front().size() - given_;
    const Index more = std::min(count - at, left);
    copy(waiting_.front(), given_, more, block, at);
    at += more;
    given_ += more;
    if (more == left) {
      waiting_.pop_front();
      --block_;
      given_ = 0;
    }
  }
  known_ -= count;
  return true;
}

// The next block of samples, or their end.
void AcceleratedSamples::read() {
  TimedBlock block;
  if (!samples_.next(block)) {
    ended_ = true;
    if (read_ != plan_.census.counts.all || block_ != waiting_.size()) {
      stream_.throwChanged();
    }
    return;
  }
  read_ += block.size();
  if (plan_.method == AccelerationMethod::kLowPass) {
    filter(block);
    block.qdd.resize(block.q.rows(), block.size());
    waiting_.push_back(std::move(block));
    interpolate();
    return;
  }
  if (plan_.method == AccelerationMethod::kBackwardDifference) {
    differentiate(block);
  }
  known_ += block.size();
  ++block_;
  waiting_.push_back(std::move(block));
}

// Backward differences.
void AcceleratedSamples::differentiate(TimedBlock& block) {
  block.qdd.setZero(block.q.rows(), block.size());
  for (Index k = 0; k < block.size(); ++k) {
    const double distance = block.time[k] - last_time_;
    if (last_qd_.size() > 0 && distance > 0.0) {
      block.qdd.col(k) = (block.qd.col(k) - last_qd_) / distance;
    }
    last_qd_ = block.qd.col(k);
    last_time_ = block.time[k];
  }
}

// Puts the used samples through the filter.
void AcceleratedSamples::filter(const TimedBlock& block) {
  for (Index k = 0; k < block.size(); ++k) {
    if (!block.used[k]) {
      continue;
    }
    if (const bool ended = plan_.grids[piece_].behind <= block.first + k;
        ended || resampler_ == nullptr) {
      piece_ += ended ? 1 : 0;
      startPiece();
    }
    const Index used = plan_.grids[piece_].used;
    if (resampler_->added() == used) {
      stream_.throwChanged();
    }
    resampler_->add(block.instant[k], block.qd.col(k).data());
    if (resampler_->added() == used) {
      differentiator_->finish();
    }
  }
}

void AcceleratedSamples::startPiece() {
  const Grid& grid = plan_.grids[piece_];
  const Index joints = plan_.census.joints;
  if (resampler_ != nullptr && resampler_->added() < plan_.grids[piece_ - 1].used) {
    stream_.throwChanged();
  }
  differentiator_ = std::make_unique<LowPassDifferentiator>(
      joints, grid.count, 1.0 / grid.period, plan_.filter.cutoff, plan_.filter.order,
      [this](const auto& accelerations) { interpolation_.add(accelerations); });
  resampler_ = std::make_unique<Resampler>(
      grid, joints, [this](const auto& values) { differentiator_->push(values); });
}

// Accelerations of samples that wait, as far as they are known.
void AcceleratedSamples::interpolate() {
  for (; block_ < waiting_.size(); ++block_, in_block_ = 0) {
    TimedBlock& block = waiting_[block_];
    for (; in_block_ < block.size(); ++in_block_, ++known_) {
      if (!interpolation_.at(block.instant[in_block_], block.qdd.col(in_block_))) {
        return;
      }
    }
  }
}

OwnedMatrix gatherAccelerations(SampleStream& stream, AccelerationPlan& plan) {
  const Index count = plan.census.counts.all;
  OwnedMatrix qdd(plan.census.joints, count);
  SampleSeries series(count);
  AcceleratedSamples samples(stream, plan);
  TimedBlock block;
  while (samples.next(block)) {
    qdd.middleCols(block.first, block.size()) = block.qdd;
    series.add(block);
  }
  series.moveTo(plan.found.report);
  return qdd;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
