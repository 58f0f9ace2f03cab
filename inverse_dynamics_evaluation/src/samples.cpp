// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include <algorithm>
#include <cmath>

#include "checks.hpp"
#include "quantile.hpp"
#include "start_transient.hpp"
#include "time_base.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

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

// Rule 5: cuts at gaps; samples of pieces that are too short aren't used.
void cutAtGaps(const TimedSamples& used, const SampleRules& rules, SampleReport& report) {
  const double gap = gapFrom(rules.longest_gap, report.period);
  const std::size_t count = used.sample.size();
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && used.time[end] - used.time[end - 1] <= gap) {
      ++end;
    }
    if (end < count) {
      report.gaps.push_back(used.sample[end]);
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
  const double gap = gapFrom(longest_gap, report.period);
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

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
