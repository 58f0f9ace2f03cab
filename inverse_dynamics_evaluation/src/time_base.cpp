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
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

constexpr double kGapPeriods = 20.0;    // a gap is longer than this many sampling periods
constexpr double kClearlyBetter = 0.8;  // of the stamps' disagreement: then another time base
constexpr double kNotWorse = 1.1;       // of the stamps' disagreement in the long run
constexpr Index kLongIntervals = 50;    // over how many intervals time bases must agree too

// Root mean square of q_(i+m) - q_i - sum of (t_(i+1) - t_i) (qd_i + qd_(i+1)) / 2 over blocks of m
// intervals; intervals over a gap are left out.
double disagreement(const TimedSamples& samples, const ConstMatrix& q, const ConstMatrix& qd,
                    Index intervals, double longest_gap) {
  const auto count = static_cast<Index>(samples.sample.size()) - 1;
  if (count < 1) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double gap = gapFrom(longest_gap, meanPeriod(samples.time, longest_gap));
  const Index block = std::min(intervals, count);
  Eigen::VectorXd error = Eigen::VectorXd::Zero(q.rows());
  double sum = 0.0;
  Index blocks = 0;
  for (Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double dt = samples.time[at + 1] - samples.time[at];
    const Index from = samples.sample[at];
    const Index to = samples.sample[at + 1];
    if (dt <= gap) {
      error += q.col(to) - q.col(from) - 0.5 * dt * (qd.col(from) + qd.col(to));
    }
    if ((i + 1) % block == 0) {
      sum += error.squaredNorm();
      error.setZero();
      ++blocks;
    }
  }
  return std::sqrt(sum / static_cast<double>(blocks));
}

}  // namespace

double gapFrom(double longest_gap, double period) {
  return std::max(longest_gap, kGapPeriods * period);
}

double meanPeriod(const std::vector<double>& time, double longest_gap) {
  double period = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (bool changed = true; changed;) {
    const double gap = gapFrom(longest_gap, period);
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 1; i < time.size(); ++i) {
      const double distance = time[i] - time[i - 1];
      sum += distance <= gap ? distance : 0.0;
      count += distance <= gap ? 1.0 : 0.0;
    }
    changed = sum / count < period;  // never empty: some distance is at most the mean
    period = std::min(period, sum / count);
  }
  return period;
}

TimedSamples timedSamples(TimeBase base, const ConstVector& time, const Mask& left_out,
                          const Mask& non_increasing) {
  TimedSamples result;
  for (Index k = 0; k < time.size(); ++k) {
    if (!left_out[k] && !(base == TimeBase::kStamps && non_increasing[k])) {
      result.sample.push_back(k);
      result.time.push_back(time[k]);
    }
  }
  if (base == TimeBase::kStamps || result.sample.size() < 2) {
    return result;
  }
  // equal distances from the first stamp to the latest one; of all samples, or of the fresh ones
  const double begin = time[0];
  const double duration = time.maxCoeff() - begin;
  const auto all = static_cast<double>(time.size() - 1);
  const auto fresh = static_cast<double>(result.sample.size() - 1);
  for (std::size_t i = 0; i < result.sample.size(); ++i) {
    const double share = base == TimeBase::kRegular ? static_cast<double>(result.sample[i]) / all
                                                    : static_cast<double>(i) / fresh;
    result.time[i] = begin + share * duration;
  }
  return result;
}

TimeBase chooseTimeBase(const std::vector<TimedSamples>& bases, const ConstMatrix& q,
                        const ConstMatrix& qd, double longest_gap, SampleReport& report) {
  for (Index b = 0; b < 3; ++b) {
    const TimedSamples& samples = bases[static_cast<std::size_t>(b)];
    report.disagreement[b] = disagreement(samples, q, qd, 1, longest_gap);
    report.long_disagreement[b] = disagreement(samples, q, qd, kLongIntervals, longest_gap);
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

Eigen::VectorXd timeOfAll(const TimedSamples& used, const Mask& repeated) {
  Eigen::VectorXd time(repeated.size());
  std::size_t next = 0;  // first used sample that isn't before k
  for (Index k = 0; k < time.size(); ++k) {
    while (next < used.sample.size() && used.sample[next] < k) {
      ++next;
    }
    if (next < used.sample.size() && used.sample[next] == k) {
      time[k] = used.time[next];
    } else if (repeated[k] || next == used.sample.size()) {
      time[k] = time[k - 1];
    } else {
      const auto before = static_cast<double>(used.sample[next - 1]);
      const auto after = static_cast<double>(used.sample[next]);
      const double share = (static_cast<double>(k) - before) / (after - before);
      time[k] = used.time[next - 1] + share * (used.time[next] - used.time[next - 1]);
    }
  }
  return time;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
