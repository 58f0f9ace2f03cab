// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "checks.hpp"
#include "examination.hpp"
#include "start_transient.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNanosecond = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Whether a sample has the numbers of the one before, bit for bit.
bool repeats(const SampleTable::JointColumns& columns, Index k) {
  const double* const numbers = columns.col(k).data();
  return std::equal(numbers, numbers + columns.rows(), numbers - columns.rows());
}

// Rules 1 and 2.
void markFaults(SampleTable& table) {
  const bool efforts = table.effort.size() > 0;
  double latest = table.time[0];
  for (Index k = 0; k < table.size(); ++k) {
    // a robot at rest may well say the same twice
    table.repeated[k] = k > 0 && repeats(table.q, k) && repeats(table.qd, k) &&
                        (!efforts || repeats(table.effort, k)) && !table.qd.col(k).isZero(0);
    table.non_increasing[k] = k > 0 && !(table.time[k] > latest);
    latest = std::max(latest, table.time[k]);
  }
}

// Between which samples distances are.
enum class Neighbours {
  kAll,    // ns
  kFresh,  // in samples; repeats that are left out aside
  kUsed,   // ns; of fresh ones, those with a stamp of their own
};

// Distances of neighbours in a table.
class Distances {
 public:
  Distances(SampleTable& table, const SampleRules& rules, Neighbours neighbours)
      : table_(table), rules_(rules), neighbours_(neighbours) {}

  /// Mean of those that are at most `limit` in size; 0 if there are none.
  double mean(double limit) const {
    double sum = 0, count = 0;
    forEach(limit, [&](double distance) { sum += distance, ++count; });
    return count > 0 ? sum / count : 0;
  }

  /// Root mean square of their deviation from it.
  double deviation(double limit) const {
    const double middle = mean(limit);
    double squares = 0, count = 0;
    forEach(limit, [&](double distance) { squares += std::pow(distance - middle, 2), ++count; });
    return count > 0 ? std::sqrt(squares / count) : 0;
  }

  /// Their median; 0 if there are none.
  double median(double limit) const {
    auto all = table_.scratch(1, table_.size());
    Index count = 0;
    forEach(limit, [&](double distance) { all(0, count++) = distance; });
    double* const middle = all.data() + (count > 0 ? (count - 1) / 2 : 0);
    if (count > 0) std::nth_element(all.data(), middle, all.data() + count);
    return count > 0 ? *middle : 0;
  }

  /// Mean, gaps aside [s]. @param unit  s; of the distances.
  double meanPeriod(double unit, double longest_gap) const {
    double period = unit * mean(kInfinity);
    for (bool changed = true; changed;) {
      const double nearer = unit * mean(gapFrom(longest_gap, period) / unit);
      changed = nearer < period;  // some distance is at most the mean
      period = std::min(period, nearer);
    }
    return period;
  }

 private:
  template <class Visit>
  void forEach(double limit, Visit visit) const {
    Index last = -1;
    for (Index k = 0; k < table_.size(); ++k) {
      const bool fresh = !(rules_.repeated && table_.repeated[k]);
      if (neighbours_ != Neighbours::kAll &&
          !(fresh && (neighbours_ == Neighbours::kFresh || !table_.non_increasing[k]))) {
        continue;
      }
      if (last >= 0) {
        const double distance =
            neighbours_ == Neighbours::kFresh
                ? static_cast<double>(k - last)
                : std::round((table_.time[k] - table_.time[last]) / kNanosecond);
        if (std::abs(distance) <= limit) visit(distance);
      }
      last = k;
    }
  }

  SampleTable& table_;
  const SampleRules& rules_;
  Neighbours neighbours_;
};

// What is counted of the faults.
struct Census {
  SampleCounts counts;
  BackwardStamp backward;
  Timing timing;   // but for the base
  Index used = 0;  // samples with a stamp of their own
};

Census takeCensus(const SampleTable& table, const SampleRules& rules) {
  Census census;
  SampleCounts& counts = census.counts;
  counts.all = census.timing.count = table.size();
  counts.repeated = table.repeated.count();
  for (Index k = 0; k < table.size(); ++k) {
    if (table.non_increasing[k] && counts.non_increasing++ == 0) {
      // all before it increase
      census.backward = {k, table.stamps()[k], table.stamps()[k - 1], table.time[k],
                         table.time[k - 1]};
    }
    const bool fresh = !(rules.repeated && table.repeated[k]);
    census.timing.fresh += fresh ? 1 : 0;
    census.used += fresh && !table.non_increasing[k] ? 1 : 0;
  }
  census.timing.begin = table.time[0];
  census.timing.duration = table.time.maxCoeff() - table.time[0];
  return census;
}

// Distances that say how far apart samples are under a time base.
class Periods {
 public:
  Periods(SampleTable& table, const Census& census, const SampleRules& rules, TimeBase base)
      : base_(base),
        longest_gap_(rules.longest_gap),
        distances_(table, rules,
                   base == TimeBase::kStamps ? Neighbours::kUsed : Neighbours::kFresh) {
    Timing timing = census.timing;
    timing.base = base;
    unit_ = base == TimeBase::kStamps ? kNanosecond : timing.step();
  }

  /// s; mean, gaps aside.
  double mean() const {
    return base_ == TimeBase::kRegularFresh ? unit_ : distances_.meanPeriod(unit_, longest_gap_);
  }
  /// s; median of those that aren't gaps: a sample that was lost doesn't change it.
  double median(double gap) const {
    return base_ == TimeBase::kRegularFresh ? unit_ : unit_ * distances_.median(gap / unit_);
  }

 private:
  TimeBase base_;
  double longest_gap_;
  Distances distances_;
  double unit_;  // s
};

// What is left to be done about stamps that don't increase.
void checkStamps(const Census& census, const SampleRules& rules, TimeBase base) {
  const Index count = census.counts.non_increasing;
  if (base != TimeBase::kStamps || count == 0) {
    return;
  }
  const std::string found = std::to_string(count) + " of " + std::to_string(census.counts.all) +
                            " that don't, the first in sample " +
                            std::to_string(census.backward.sample + 1) +
                            " (counted from 1): " + std::to_string(census.backward.time) +
                            " s after " + std::to_string(census.backward.time_before) + " s";
  if (!rules.non_increasing) {
    throw EvaluationError("samples", "time", "stamps that increase", found,
                          "switch the rule for stamps that don't increase on, or sort the samples");
  }
  if (2 * count > census.counts.all) {
    throw EvaluationError("samples", "time", "stamps of which half increase or more", found,
                          "take other stamps: those of the recorder, or those in the messages");
  }
}

// Rule 3: what each time base makes of the samples.
std::vector<TimeBaseSums> sumsOfBases(SampleTable& table, const Census& census,
                                      const SampleRules& rules) {
  std::vector<TimeBaseSums> bases;
  for (const TimeBase base : {TimeBase::kStamps, TimeBase::kRegular, TimeBase::kRegularFresh}) {
    Timing timing = census.timing;
    timing.base = base;
    const double period = Periods(table, census, rules, base).mean();
    bases.emplace_back(timing, gapFrom(rules.longest_gap, period),
                       base == TimeBase::kStamps ? census.used : census.timing.fresh,
                       rules.shortest_piece, table.q.rows());
  }
  Index fresh = 0;
  for (Index k = 0; k < table.size(); ++k) {
    if (rules.repeated && table.repeated[k]) continue;
    for (TimeBaseSums& base : bases) {
      if (base.timing().uses(table.non_increasing[k])) {
        base.add(k, base.timing()(k, fresh, table.time[k]), table.q.col(k).data(),
                 table.qd.col(k).data(), k > 0 ? table.stamps()[k - 1] : 0);
      }
    }
    ++fresh;
  }
  for (TimeBaseSums& base : bases) {
    base.finish();
  }
  return bases;
}

// When each sample was taken, whether it lies in a piece, and whether it is used.
void setInstants(SampleTable& table, const Timing& timing, const std::vector<Piece>& pieces,
                 const SampleRules& rules) {
  std::size_t piece = 0;  // the first one that doesn't lie before the sample
  Index fresh = 0;        // samples so far that aren't repeats
  Index last = 0;         // the last sample with an instant of its own
  Index known = 0;        // samples whose instant is known
  double before = 0;      // s; of the last of them
  const auto left_out = [&](Index k) { return rules.repeated && table.repeated[k]; };
  for (Index k = 0; k < table.size(); ++k) {
    while (piece < pieces.size() && pieces[piece].behind <= k) ++piece;
    const bool own = !left_out(k) && timing.uses(table.non_increasing[k]);
    table.isolated[k] = piece == pieces.size() || k < pieces[piece].first;
    table.used[k] = own && !table.isolated[k];
    if (own) {
      const double from = table.instant[last];
      const double instant = timing(k, fresh, table.time[k]);
      for (; known < k; ++known) {  // those that wait lie between their neighbours
        if (!left_out(known)) {
          const double share = static_cast<double>(known - last) / static_cast<double>(k - last);
          before = from + share * (instant - from);
        }
        table.instant[known] = before;
      }
      table.instant[k] = before = instant;
      last = k;
      known = k + 1;
    }
    fresh += left_out(k) ? 0 : 1;
  }
  table.instant.tail(table.size() - known).setConstant(before);
}

// Rule 4: how many samples there are up to the end of a start transient.
Index lookAtStart(const SampleTable& table, Index fresh, double period, const SampleRules& rules) {
  if (table.effort.size() == 0) return 0;
  const Index most = std::min(fresh, kMostForTransient);
  MatrixXd effort(table.effort.rows(), most);
  VectorXd instant(most);
  std::vector<Index> number;
  for (Index k = 0; static_cast<Index>(number.size()) < most; ++k) {
    if (rules.repeated && table.repeated[k]) continue;
    const auto i = static_cast<Index>(number.size());
    effort.col(i) = table.effort.col(k);
    instant[i] = table.instant[k];
    number.push_back(k);
  }
  const Index end = startTransient(effort, instant, period, rules.start_window);
  return end > 0 ? number[static_cast<std::size_t>(end - 1)] + 1 : 0;
}

// Which samples count, all rules together.
void markKept(SampleTable& table, const SampleRules& rules, SampleCounts& counts) {
  table.start_transient.setConstant(false);
  table.start_transient.head(counts.start_transient).setConstant(true);
  table.kept = table.used;
  if (rules.start_transient) table.kept.head(counts.start_transient).setConstant(false);
  counts.isolated = table.isolated.count();
  counts.kept = table.kept.count();
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

Examination examine(SampleTable& table, const SampleRules& rules) {
  markFaults(table);
  const Census census = takeCensus(table, rules);
  const std::vector<TimeBaseSums> bases = sumsOfBases(table, census, rules);
  Examination found;
  SampleReport& report = found.report;
  report.backward = census.backward;
  const TimeBase fitting = chooseTimeBase(bases, report);
  report.time_base = rules.time_base ? fitting : TimeBase::kStamps;
  checkStamps(census, rules, report.time_base);
  const TimeBaseSums& base = bases[static_cast<std::size_t>(report.time_base)];
  const Index used = report.time_base == TimeBase::kStamps ? census.used : census.timing.fresh;
  if (used < 2) {
    throw EvaluationError("samples", "samples",
                          "2 or more that differ and have a stamp of their own",
                          std::to_string(used), "record a motion");
  }
  found.pieces = base.pieces();
  for (const Piece& piece : found.pieces) {
    report.pieces.push_back(piece.first);
  }
  report.gaps = base.gaps();
  report.longest_gap = base.longestGap();
  const Periods periods(table, census, rules, report.time_base);
  report.period = periods.mean();
  const double gap = gapFrom(rules.longest_gap, report.period);
  // at least half of the mean distance, as most samples of a recording may come in bursts
  found.usual_period = std::max(periods.median(gap), 0.5 * report.period);
  const Distances stamps(table, rules, Neighbours::kAll);
  report.stamped_period = kNanosecond * stamps.median(kInfinity);
  report.jitter = kNanosecond * stamps.deviation(gap / kNanosecond);

  setInstants(table, base.timing(), found.pieces, rules);
  report.counts = census.counts;
  report.counts.start_transient = lookAtStart(table, census.timing.fresh, report.period, rules);
  markKept(table, rules, report.counts);
  return found;
}

std::unique_ptr<SampleTable> tableOf(const Eigen::Ref<const VectorXd>& time,
                                     const Eigen::Ref<const MatrixXd>& q,
                                     const Eigen::Ref<const MatrixXd>& qd,
                                     const Eigen::Ref<const MatrixXd>& effort) {
  const Stamps stamps = (time * 1e9).array().round().cast<std::int64_t>();  // for texts
  auto table = tableOf({stamps, stamps, Clock::kHeader, q, qd, effort, MatrixXd()});
  table->time = time;
  return table;
}

std::unique_ptr<SampleTable> tableOf(const JointLogView& log) {
  auto table = std::make_unique<SampleTable>();
  table->append(log);
  table->complete(log.clock);
  return table;
}

void addSeries(const SampleTable& table, SampleReport& report) {
  report.repeated = table.repeated;
  report.non_increasing = table.non_increasing;
  report.start_transient = table.start_transient;
  report.isolated = table.isolated;
  report.used = table.used;
  report.kept = table.kept;
  report.time = table.instant;
}

SampleReport examineSamples(const Eigen::Ref<const VectorXd>& time,
                            const Eigen::Ref<const MatrixXd>& q,
                            const Eigen::Ref<const MatrixXd>& qd,
                            const Eigen::Ref<const MatrixXd>& effort, const SampleRules& rules) {
  checkSamples(time, q, qd, effort);
  const auto table = tableOf(time, q, qd, effort);
  Examination found = examine(*table, rules);
  addSeries(*table, found.report);
  return std::move(found.report);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
