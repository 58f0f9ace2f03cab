// SPDX-License-Identifier: Apache-2.0

#include "time_base.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr double kGapPeriods = 20.0;    // a gap is longer than this many sampling periods
constexpr double kClearlyBetter = 0.8;  // of the stamps' disagreement: then another time base
constexpr double kNotWorse = 1.1;       // of the stamps' disagreement in the long run
constexpr Index kLongIntervals = 50;    // over how many intervals time bases must agree too

}  // namespace

double gapFrom(double longest_gap, double period) {
  return std::max(longest_gap, kGapPeriods * period);
}

double Timing::step() const {
  const Index samples = base == TimeBase::kRegularFresh ? fresh : count;
  return samples > 1 ? duration / static_cast<double>(samples - 1) : 0.0;
}

double Timing::operator()(Index k, Index i, double stamp) const {
  if (base == TimeBase::kStamps || fresh < 2) {
    return stamp;
  }
  const double share = base == TimeBase::kRegular
                           ? static_cast<double>(k) / static_cast<double>(count - 1)
                           : static_cast<double>(i) / static_cast<double>(fresh - 1);
  return begin + share * duration;
}

TimeBaseSums::TimeBaseSums(const Timing& timing, double gap, Index used, Index shortest,
                           Index joints)
    : timing_(timing),
      gap_(gap),
      short_{1},
      long_{std::clamp<Index>(used - 1, 1, kLongIntervals)},
      q_(joints),
      qd_(joints),
      error_(joints),
      shortest_(shortest) {
  short_.error = long_.error = Eigen::ArrayXd::Zero(joints);
}

void TimeBaseSums::Disagreement::add(const Eigen::ArrayXd& next) {
  error += next;
  if (++added % intervals == 0) {
    sum += error.square().sum();
    error.setZero();
    ++blocks;
  }
}

double TimeBaseSums::Disagreement::rms() const {
  return blocks > 0 ? std::sqrt(sum / static_cast<double>(blocks))
                    : std::numeric_limits<double>::quiet_NaN();
}

void TimeBaseSums::add(Index k, double time, const double* q, const double* qd,
                       std::int64_t stamp_before) {
  const Eigen::Map<const Eigen::ArrayXd> next_q(q, q_.size());
  const Eigen::Map<const Eigen::ArrayXd> next_qd(qd, qd_.size());
  const double distance = time - time_;
  const bool begins = piece_.used == 0 || !(distance <= gap_);
  if (piece_.used > 0) {
    if (begins) {
      error_.setZero();
    } else {
      error_ = next_q - q_ - 0.5 * distance * (qd_ + next_qd);
    }
    short_.add(error_);
    long_.add(error_);
  }
  if (begins) {
    if (piece_.used > 0) {
      endPiece(k);
      gaps_.push_back(k);
      if (longest_gap_.behind == 0 || distance > longest_gap_.length) {
        longest_gap_ = {k, distance, stamp_before};
      }
    }
    piece_ = {k, k, 0, time, time};
  }
  ++piece_.used;
  piece_.end = time;
  time_ = time;
  q_ = next_q;
  qd_ = next_qd;
}

void TimeBaseSums::endPiece(Index behind) {
  piece_.behind = behind;
  if (piece_.used >= shortest_) {
    pieces_.push_back(piece_);
  }
}

// The last piece goes on to the last sample, repeats and all.
void TimeBaseSums::finish() {
  if (piece_.used > 0) {
    endPiece(timing_.count);
  }
}

TimeBase chooseTimeBase(const std::vector<TimeBaseSums>& bases, SampleReport& report) {
  for (Index b = 0; b < 3; ++b) {
    report.disagreement[b] = bases[static_cast<std::size_t>(b)].disagreement();
    report.long_disagreement[b] = bases[static_cast<std::size_t>(b)].longDisagreement();
  }
  TimeBase best = TimeBase::kStamps;
  double least = kClearlyBetter * report.disagreement[0];
  for (const TimeBase base : {TimeBase::kRegular, TimeBase::kRegularFresh}) {
    const auto b = static_cast<Index>(base);
    if (report.disagreement[b] < least &&
        report.long_disagreement[b] <= kNotWorse * report.long_disagreement[0]) {
      best = base;
      least = report.disagreement[b];
    }
  }
  return best;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
