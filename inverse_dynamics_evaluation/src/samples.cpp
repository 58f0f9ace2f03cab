// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

constexpr double kGapPeriods = 20.0;        // a gap is longer than this many sampling periods
constexpr double kClearlyBetter = 0.8;      // of the stamps' disagreement: then another time base
constexpr double kNotWorse = 1.1;           // of the stamps' disagreement in the long run
constexpr Index kLongIntervals = 50;        // over how many intervals time bases must agree too
constexpr double kTransientQuantile = 0.9;  // of the roughness of the efforts,
constexpr double kTransientFactor = 5.0;    // and how far a transient exceeds it
constexpr Index kLeastForTransient = 50;    // samples without which that quantile says nothing

// Some of the samples, and when they were taken.
struct TimedSamples {
  std::vector<Index> sample;  // increasing
  std::vector<double> time;   // s; increasing
};

Mask repeatedSamples(const ConstMatrix& q, const ConstMatrix& qd, const ConstMatrix& effort) {
  Mask repeated = Mask::Constant(q.cols(), false);
  for (Index k = 1; k < q.cols(); ++k) {
    // a robot at rest may well say the same twice
    repeated[k] = q.col(k) == q.col(k - 1) && qd.col(k) == qd.col(k - 1) &&
                  (effort.size() == 0 || effort.col(k) == effort.col(k - 1)) &&
                  !qd.col(k).isZero(0);
  }
  return repeated;
}

Mask nonIncreasingStamps(const ConstVector& time) {
  Mask result = Mask::Constant(time.size(), false);
  double latest = time[0];
  for (Index k = 1; k < time.size(); ++k) {
    result[k] = !(time[k] > latest);
    latest = std::max(latest, time[k]);
  }
  return result;
}

// Mean distance in time, gaps aside; a gap is longer than `longest_gap` and 20 times that mean.
double meanPeriod(const std::vector<double>& time, double longest_gap) {
  double period = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (bool changed = true; changed;) {
    const double gap = std::max(longest_gap, kGapPeriods * period);
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

// The fresh samples under a time base; for the stamps, those that increase.
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

// Root mean square of q_(i+m) - q_i - sum of (t_(i+1) - t_i) (qd_i + qd_(i+1)) / 2 over blocks of m
// intervals; intervals over a gap are left out.
double disagreement(const TimedSamples& samples, const ConstMatrix& q, const ConstMatrix& qd,
                    Index intervals, double longest_gap) {
  const auto count = static_cast<Index>(samples.sample.size()) - 1;
  if (count < 1) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double gap = std::max(longest_gap, kGapPeriods * meanPeriod(samples.time, longest_gap));
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

// Rule 3: which time base q and qd agree with; writes what they say.
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

// An instant for every sample: a repeat has that of the sample it repeats; one left out for its
// stamp lies between its neighbours in the recording.
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

double quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// Second difference of three samples, as if they lay `period` apart: a sample that was missed
// beside them makes none of it. (Distances far below the period are those of stamps that jitter.)
double secondDifference(const Eigen::Vector3d& value, double before, double after, double period) {
  const double h1 = std::max(before / period, 0.5);
  const double h2 = std::max(after / period, 0.5);
  return 2.0 * ((value[2] - value[1]) / h2 - (value[1] - value[0]) / h1) / (h1 + h2);
}

// Roughness of the efforts about each inner one of the samples: second differences in units of each
// joint's median, root mean square over the joints that change.
std::vector<double> roughness(const ConstMatrix& effort, const std::vector<Index>& sample,
                              const Eigen::VectorXd& time, double period) {
  const std::size_t inner = sample.size() - 2;
  std::vector<double> sum(inner, 0.0);
  double joints = 0.0;
  std::vector<double> second(inner);
  for (Index j = 0; j < effort.rows(); ++j) {
    for (std::size_t i = 0; i < inner; ++i) {
      const Index a = sample[i];
      const Index b = sample[i + 1];
      const Index c = sample[i + 2];
      second[i] = std::abs(secondDifference({effort(j, a), effort(j, b), effort(j, c)},
                                            time[b] - time[a], time[c] - time[b], period));
    }
    const double scale = quantile(second, 0.5);
    if (scale > 0) {
      joints += 1.0;
      for (std::size_t i = 0; i < inner; ++i) {
        sum[i] += std::pow(second[i] / scale, 2);
      }
    }
  }
  for (double& value : sum) {
    value = joints > 0 ? std::sqrt(value / joints) : 0.0;
  }
  return sum;
}

// Rule 4. `sample`: the fresh ones.
Mask startTransient(const ConstMatrix& effort, const std::vector<Index>& sample,
                    const Eigen::VectorXd& time, double period, double window) {
  Mask transient = Mask::Constant(time.size(), false);
  if (effort.size() == 0 || static_cast<Index>(sample.size()) < kLeastForTransient) {
    return transient;
  }
  const std::vector<double> rough = roughness(effort, sample, time, period);
  const double limit = kTransientFactor * quantile(rough, kTransientQuantile);
  Index end = 0;
  for (std::size_t i = 0; i < rough.size() && time[sample[i + 1]] - time[0] <= window; ++i) {
    if (rough[i] > limit) {
      end = sample[i + 1] + 1;  // the sample in the middle of the three
    }
  }
  transient.head(end).setConstant(true);
  return transient;
}

// Rule 5: cuts at gaps; samples of pieces that are too short aren't used.
void cutAtGaps(const TimedSamples& used, const SampleRules& rules, SampleReport& report) {
  const double gap = std::max(rules.longest_gap, kGapPeriods * report.period);
  const std::size_t count = used.sample.size();
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && used.time[end] - used.time[end - 1] <= gap) {
      ++end;
    }
    // the last piece goes on to the last sample, repeats and all
    const Index first = used.sample[begin];
    const Index behind = end < count ? used.sample[end] : report.isolated.size();
    if (static_cast<Index>(end - begin) < rules.shortest_piece) {
      report.isolated.segment(first, behind - first).setConstant(true);
    } else {
      report.pieces.push_back(first);
    }
    begin = end;
  }
}

void stampStatistics(const ConstVector& time, double longest_gap, SampleReport& report) {
  std::vector<double> distances;
  for (Index k = 1; k < time.size(); ++k) {
    distances.push_back(time[k] - time[k - 1]);
  }
  report.stamped_period = quantile(distances, 0.5);
  const double gap = std::max(longest_gap, kGapPeriods * report.period);
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (const double distance : distances) {
    if (std::abs(distance) <= gap) {
      sum += distance;
      squares += distance * distance;
      count += 1.0;
    }
  }
  report.jitter = std::sqrt(std::max(0.0, squares / count - std::pow(sum / count, 2)));
}

void checkSamples(const ConstVector& time, const ConstMatrix& q, const ConstMatrix& qd,
                  const ConstMatrix& effort) {
  requireSamples("samples", "qd", qd, 2);
  requireSameSize("samples", "q", q, "qd", qd);
  requireStampPerSample("samples", time, qd);
  requireFiniteStamps("samples", time);
  requireFinite("samples", "q", q);
  requireFinite("samples", "qd", qd);
  if (effort.size() > 0) {
    requireSameSize("samples", "effort", effort, "qd", qd);
    requireFinite("samples", "effort", effort);
  }
}

// What is left to be done about stamps that don't increase.
void checkStamps(const ConstVector& time, const SampleRules& rules, const SampleReport& report) {
  if (report.time_base != TimeBase::kStamps || !report.non_increasing.any()) {
    return;
  }
  Index first = 0;
  while (!report.non_increasing[first]) {
    ++first;
  }
  const std::string found = std::to_string(report.non_increasing.count()) + " of " +
                            std::to_string(time.size()) + " that don't, the first in sample " +
                            std::to_string(first) +
                            " (counted from 0): " + std::to_string(time[first]) + " s after " +
                            std::to_string(time[first - 1]) + " s";
  if (!rules.non_increasing) {
    throw EvaluationError("samples", "time", "stamps that increase", found,
                          "switch the rule for stamps that don't increase on, or sort the samples");
  }
  if (2 * report.non_increasing.count() > time.size()) {
    throw EvaluationError("samples", "time", "stamps of which half increase or more", found,
                          "take other stamps: those of the recorder, or those in the messages");
  }
}

}  // namespace

std::string name(TimeBase time_base) {
  switch (time_base) {
    case TimeBase::kStamps:
      return "stamps";
    case TimeBase::kRegular:
      return "regular";
    case TimeBase::kRegularFresh:
      return "regular_fresh";
  }
  return "unknown";
}

SampleReport examineSamples(const Eigen::Ref<const Eigen::VectorXd>& time,
                            const Eigen::Ref<const Eigen::MatrixXd>& q,
                            const Eigen::Ref<const Eigen::MatrixXd>& qd,
                            const Eigen::Ref<const Eigen::MatrixXd>& effort,
                            const SampleRules& rules) {
  checkSamples(time, q, qd, effort);
  const Index count = time.size();
  const Mask none = Mask::Constant(count, false);
  SampleReport report;

  // rules 1 and 2: what is there
  report.repeated = repeatedSamples(q, qd, effort);
  report.non_increasing = nonIncreasingStamps(time);
  const Mask left_out = rules.repeated ? report.repeated : none;

  // rule 3: when it was
  std::vector<TimedSamples> bases;
  for (const TimeBase base : {TimeBase::kStamps, TimeBase::kRegular, TimeBase::kRegularFresh}) {
    bases.push_back(timedSamples(base, time, left_out, report.non_increasing));
  }
  const TimeBase fitting = chooseTimeBase(bases, q, qd, rules.longest_gap, report);
  report.time_base = rules.time_base ? fitting : TimeBase::kStamps;
  checkStamps(time, rules, report);
  const TimedSamples& used = bases[static_cast<std::size_t>(report.time_base)];
  if (used.sample.size() < 2) {
    throw EvaluationError("samples", "samples",
                          "2 or more that differ and have a stamp of their own",
                          std::to_string(used.sample.size()), "record a motion");
  }
  report.time = timeOfAll(used, left_out);
  report.period = meanPeriod(used.time, rules.longest_gap);
  stampStatistics(time, rules.longest_gap, report);

  // rules 4 and 5: what can't be judged
  report.start_transient =
      startTransient(effort, bases[static_cast<std::size_t>(TimeBase::kRegular)].sample,
                     report.time, report.period, rules.start_window);
  report.isolated = none;
  cutAtGaps(used, rules, report);

  report.used = none;
  for (const Index k : used.sample) {
    report.used[k] = !report.isolated[k];
  }
  report.kept = report.used && !(rules.start_transient ? report.start_transient : none);
  return report;
}

}  // namespace inverse_dynamics_evaluation
