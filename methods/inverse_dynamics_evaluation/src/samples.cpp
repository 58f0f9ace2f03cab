// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"
#include "sources.hpp"
#include "start_transient.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using chain_dynamics::JointType;
using chain_dynamics::unwrapped;
using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNanosecond = 1e-9;
constexpr double kJust = 1 + 1e-9;  // times a limit: rounding doesn't take a distance beyond it
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Index kDelayed = 8;         // samples; a publisher that repeats another is no later
constexpr double kGapPeriods = 10.0;  // a gap is longer than this many sampling periods
constexpr double kBeyond =
    1.1;  // times the longest gap that is bridged: behind a step of the clock
constexpr double kClearlyBetter = 0.8;  // of the stamps' disagreement: then another time base
constexpr double kNotWorse = 1.1;       // of the stamps' disagreement in the long run
constexpr Index kLongIntervals = 50;    // over how many intervals time bases must agree too

// Where a gap is longer than this [s], the recording is cut.
double gapFrom(double longest_gap, double period) {
  return std::max(longest_gap, kGapPeriods * period);
}

// Whether a sample has the numbers of an earlier one, bit for bit.
bool repeats(const SampleTable::JointColumns& columns, Index k, Index earlier) {
  const double* const numbers = columns.col(k).data();
  return std::equal(numbers, numbers + columns.rows(), columns.col(earlier).data());
}

// Rules 1 and 2.
void markFaults(SampleTable& table, const SampleRules& rules, SampleReport& report) {
  const bool efforts = table.effort.size() > 0;
  for (Index k = 0; k < table.size(); ++k) {
    // a robot at rest may well say the same twice
    const bool moves = !table.qd.col(k).isZero(0);
    table.repeated[k] = false;
    for (Index i = k - 1; moves && i >= std::max<Index>(k - kDelayed, 0); --i) {
      if (!repeats(table.q, k, i) || !repeats(table.qd, k, i)) continue;
      table.repeated[k] = !efforts || repeats(table.effort, k, i);
      if (table.repeated[k]) break;
    }
  }
  report.second_source = markSecondSource(table);
  if (rules.non_increasing) report.clock_steps = undoClockSteps(table, kBeyond * rules.longest_gap);
  if (rules.repeated) markLate(table);
  double latest = table.time[0];
  for (Index k = 0; k < table.size(); ++k) {
    table.non_increasing[k] = k > 0 && !(table.time[k] > latest);
    latest = std::max(latest, table.time[k]);
  }
}

// When each sample was taken, under a time base.
struct Timing {
  // s; of sample `k`, which is fresh sample number `i`.
  double operator()(Index k, Index i, double stamp) const {
    if (base == TimeBase::kStamps || fresh < 2) return stamp;
    const double share = base == TimeBase::kRegular
                             ? static_cast<double>(k) / static_cast<double>(count - 1)
                             : static_cast<double>(i) / static_cast<double>(fresh - 1);
    return begin + share * duration;
  }

  // Whether a fresh sample has an instant of its own.
  bool uses(bool non_increasing) const {
    return every || base != TimeBase::kStamps || !non_increasing;
  }

  // s; of distances: stamps are whole nanoseconds, which sums then keep exactly.
  double unit() const { return base == TimeBase::kStamps ? kNanosecond : 1.0; }

  TimeBase base = TimeBase::kStamps;
  bool every = false;   // as stamped, also where stamps don't increase
  Index count = 0;      // N; samples
  Index fresh = 0;      // of them, without repeats that are left out
  double begin = 0;     // s; first stamp
  double duration = 0;  // s; from there to the latest stamp
};

// Second differences of one wrong number are -1, 2, -1 times its error: shares of their squares.
constexpr double kOfThree = 0.9;                        // at least, of those of all samples
constexpr double kLeastOfOne = 0.55, kMostOfOne = 0.8;  // of the three, in the middle: 4 of 6
constexpr double kBeside = 0.1;  // at least, on each side, of that in the middle: 1 of 4

// The sample of a joint whose number can't be right; 0: none.
Index loneSample(const SampleTable::JointColumns& columns, Index j) {
  const auto square = [&](Index k) {
    return std::pow(columns(j, k - 1) - 2.0 * columns(j, k) + columns(j, k + 1), 2);
  };
  const Index last = columns.cols() - 1;
  double sum = 0, greatest = 0;
  Index middle = 0;
  for (Index k = 1; k < last; ++k) {
    const double value = square(k);
    sum += value;
    if (value > greatest) greatest = value, middle = k;
  }
  if (middle < 2 || middle + 2 > last) return 0;
  const double before = square(middle - 1), after = square(middle + 1);
  if (std::min(before, after) < kBeside * greatest) return 0;  // what moved on in a gap
  const double three = before + greatest + after;
  const double share = greatest / three;
  return three > kOfThree * sum && share > kLeastOfOne && share < kMostOfOne ? middle : 0;
}

LoneSample findLoneSample(const SampleTable& table) {
  for (Index j = 0; j < table.q.rows(); ++j) {
    for (const SampleTable::JointColumns* columns : {&table.qd, &table.q}) {
      if (const Index k = loneSample(*columns, j); k > 0 && !table.repeated[k])
        return {k, j, table.stamps()[k]};
    }
  }
  return {};
}

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

// Calls `visit(k, time)` with the samples that have an instant of their own under a time base.
template <class Visit>
void forEachOwn(const SampleTable& table, const SampleRules& rules, const Timing& timing,
                Visit visit) {
  Index fresh = 0;  // samples before that are
  for (Index k = 0; k < table.size(); ++k) {
    if (rules.repeated && table.repeated[k]) continue;
    const double time = timing(k, fresh++, table.time[k]);
    if (timing.uses(table.non_increasing[k])) visit(k, time);
  }
}

// Distances of neighbours among those samples, in the table's scratch memory. Limits are in s.
class Distances {
 public:
  Distances(SampleTable& table, const SampleRules& rules, const Timing& timing)
      : unit_(timing.unit()), memory_(table.scratch(1, table.size())) {
    double before = std::numeric_limits<double>::quiet_NaN();
    forEachOwn(table, rules, timing, [&](Index /*k*/, double time) {
      const double distance = time - std::exchange(before, time);
      if (std::isnan(distance)) return;
      memory_(0, count_++) = unit_ == kNanosecond ? std::round(distance / unit_) : distance;
    });
  }

  /// Mean of those up to a limit [s]; 0 if there are none.
  double mean(double limit) const {
    const auto near = upTo(limit);
    return near.any() ? unit_ * (near.select(all(), 0.0).sum() / count(near)) : 0;
  }

  /// Mean, gaps aside [s].
  double meanPeriod(double longest_gap) const {
    double period = mean(kInfinity);
    for (bool changed = true; changed;) {
      const double nearer = mean(kJust * gapFrom(longest_gap, period));
      changed = nearer < period;  // some distance is at most the mean
      period = std::min(period, nearer);
    }
    return period;
  }

  /// Median of those up to a limit [s]: a sample that was lost doesn't change it.
  double median(double limit) {
    double* const begin = memory_.data();
    double* const end = std::partition(begin, begin + count_, [&](double distance) {
      return std::abs(distance) <= limit / unit_;
    });
    double* const middle = begin + std::max<std::ptrdiff_t>(end - begin - 1, 0) / 2;
    if (begin < end) std::nth_element(begin, middle, end);
    return begin < end ? unit_ * *middle : 0;
  }

  /// Root mean square by which those up to a limit deviate from their mean [s].
  double deviation(double limit) const {
    const auto near = upTo(limit);
    const double middle = mean(limit) / unit_;
    if (!near.any()) return 0;
    return unit_ * std::sqrt(near.select((all() - middle).square(), 0.0).sum() / count(near));
  }

 private:
  Eigen::Map<const ArrayXd> all() const { return {memory_.data(), count_}; }
  Eigen::Array<bool, Eigen::Dynamic, 1> upTo(double limit) const {
    return all().abs() <= limit / unit_;
  }
  static double count(const Eigen::Array<bool, Eigen::Dynamic, 1>& near) {
    return static_cast<double>(near.count());
  }

  double unit_;  // s
  SampleTable::JointColumns memory_;
  Index count_ = 0;
};

// What is left to be done about stamps that don't increase.
void checkStamps(const Census& census, const SampleRules& rules, TimeBase base) {
  const Index count = census.counts.non_increasing;
  if (base != TimeBase::kStamps || count == 0) return;
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

// Root mean square of q_(i+m) - q_i - sum of (t_(i+1) - t_i) (qd_i + qd_(i+1)) / 2 over blocks of m
// intervals; intervals over a gap are left out.
struct Disagreement {
  Disagreement(Index m, Index joints) : intervals(m), error(ArrayXd::Zero(joints)) {}

  void add(const ArrayXd& next) {
    error += next;
    if (++added % intervals == 0) {
      sum += error.square().sum();
      error.setZero();
      ++blocks;
    }
  }

  // NaN if there is none.
  double rms() const {
    return blocks > 0 ? std::sqrt(sum / static_cast<double>(blocks))
                      : std::numeric_limits<double>::quiet_NaN();
  }

  Index intervals;  // m
  ArrayXd error;
  double sum = 0;
  Index added = 0, blocks = 0;
};

// What a time base makes of the samples.
struct Base {
  // A piece is at its end before sample `behind`.
  void end(Piece piece, Index behind, Index shortest) {
    piece.behind = behind;
    if (piece.used >= shortest) pieces.push_back(piece);
  }

  // There is a gap before sample `behind`.
  void notice(Index behind, double length, std::int64_t stamp_before) {
    if (length > longest_gap.length) longest_gap = {behind, length, stamp_before};
  }

  Timing timing;
  double disagreement = 0, long_disagreement = 0;  // over one interval, over 50
  std::vector<Piece> pieces;
  std::vector<Index> gaps;  // first samples behind those that cut
  LongestGap longest_gap;
};

// Rules 3 and 5. period [s]: mean distance of samples; `used`: how many have an instant.
Base tryTimeBase(const SampleTable& table, const Timing& timing, double period, Index used,
                 const SampleRules& rules) {
  const double least = kJust * kGapPeriods * period;
  const double cut = gapFrom(rules.longest_gap, period);
  Base base;
  base.timing = timing;
  Disagreement one(1, table.q.rows());
  Disagreement many(std::clamp<Index>(used - 1, 1, kLongIntervals), table.q.rows());
  ArrayXd error(table.q.rows());
  Piece piece;
  Index before = -1;  // the sample before that has an instant
  forEachOwn(table, rules, timing, [&](Index k, double time) {
    const double distance = time - piece.end;
    const bool begins = before < 0 || distance > cut;
    if (begins) {
      error.setZero();
    } else {
      error = table.q.col(k) - table.q.col(before) -
              0.5 * distance * (table.qd.col(before) + table.qd.col(k));
    }
    if (before >= 0) {
      one.add(error);
      many.add(error);
    }
    if (before >= 0 && distance > least) base.notice(k, distance, table.stamps()[k - 1]);
    if (begins && before >= 0) {
      base.end(piece, k, rules.shortest_piece);
      base.gaps.push_back(k);
    }
    if (begins) piece = {k, k, 0, time, time};
    ++piece.used;
    piece.end = time;
    before = k;
  });
  base.end(piece, table.size(), rules.shortest_piece);  // repeats at the end and all
  base.disagreement = one.rms();
  base.long_disagreement = many.rms();
  return base;
}

// The time bases, in the order of TimeBase.
std::vector<Base> tryTimeBases(SampleTable& table, const Census& census, const SampleRules& rules) {
  std::vector<Base> bases;
  for (const TimeBase base : {TimeBase::kStamps, TimeBase::kRegular, TimeBase::kRegularFresh}) {
    Timing timing = census.timing;
    timing.base = base;
    const double period = Distances(table, rules, timing).meanPeriod(rules.longest_gap);
    const Index used = base == TimeBase::kStamps ? census.used : census.timing.fresh;
    bases.push_back(tryTimeBase(table, timing, period, used, rules));
  }
  return bases;
}

// The time base that q and qd agree with; writes what they say.
TimeBase chooseTimeBase(const std::vector<Base>& bases, SampleReport& report) {
  for (Index b = 0; b < 3; ++b) {
    report.disagreement[b] = bases[static_cast<std::size_t>(b)].disagreement;
    report.long_disagreement[b] = bases[static_cast<std::size_t>(b)].long_disagreement;
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

constexpr double kStill = 0.05;  // of the way of all joints: a start transient holds no more of it

// How many of the first samples the joints go no more than that share of their way in.
Index standingStill(const SampleTable& table) {
  const Index steps = table.size() - 1;
  const auto way = [&](Index k) { return (table.q.col(k + 1) - table.q.col(k)).cwiseAbs().sum(); };
  double whole = 0, gone = 0;
  for (Index k = 0; k < steps; ++k) whole += way(k);
  for (Index k = 0; k < steps; ++k) {
    gone += way(k);
    if (gone > kStill * whole) return k + 1;
  }
  return table.size();
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
  const double still = table.instant[standingStill(table) - 1] - instant[0];
  const Index end = startTransient(effort, instant, period, std::min(rules.start_window, still));
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

// A driver that reports within one turn jumps by one. A longer jump is of other units (360 degrees
// are 57 turns of a radian) or of another start, and stays for the diagnosis to see.
constexpr double kLongestJump = 1.5 * 2.0 * M_PI;  // rad

// What a whole turn may be off by where velocity and time between two samples say how far the joint
// went: 3 rad/s over stamps that are wrong by 30 ms.
constexpr double kSeam = 0.1;  // rad

// Jumps of a joint by a whole turn.
struct Jumps {
  Index count = 0;
  Index first = 0;  // number of the sample
};

// Unwraps a continuous joint; finds the jumps of a revolute one.
Jumps unwrapJoint(SampleTable& table, Index j, JointType type) {
  Jumps jumps;
  double offset = 0.0;  // rad; whole turns that positions get
  double before = table.q(j, 0);
  for (Index k = 1; k < table.size(); ++k) {
    const double recorded = table.q(j, k), change = recorded - before;
    if (std::abs(change) > M_PI && std::abs(change) < kLongestJump) {
      const double turn = unwrapped(JointType::kContinuous, recorded, before) - recorded;
      const double way =
          0.5 * (table.time[k] - table.time[k - 1]) * (table.qd(j, k - 1) + table.qd(j, k));
      if (type == JointType::kContinuous) {
        // unless velocity says that the joint went there: in degrees it goes far between samples
        if (std::abs(change + turn - way) < std::abs(change - way)) offset += turn;
      } else if (std::abs(change + turn - way) < kSeam) {
        if (jumps.count++ == 0) jumps.first = k;
      }
    }
    before = recorded;
    if (offset != 0.0) table.q(j, k) += offset;
  }
  return jumps;
}

}  // namespace

std::vector<std::string> unwrapPositions(SampleTable& table, const std::vector<JointType>& types,
                                         const std::vector<std::string>& joint_names) {
  std::vector<std::string> found;
  if (table.q.rows() != static_cast<Index>(types.size()) || table.size() == 0) return found;
  for (std::size_t j = 0; j < types.size(); ++j) {
    if (types[j] != JointType::kContinuous && types[j] != JointType::kRevolute) continue;
    const Jumps jumps = unwrapJoint(table, static_cast<Index>(j), types[j]);
    if (jumps.count == 0) continue;
    found.push_back("positions of " + joint_names[j] + " jump by a whole turn " +
                    std::to_string(jumps.count) + (jumps.count == 1 ? " time" : " times, first") +
                    " in sample " + std::to_string(jumps.first + 1) +
                    ", and stay as recorded: the robot's model says that the joint is revolute; if "
                    "it has no limits, state it as continuous");
  }
  return found;
}

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

SampleReport examineSamples(SampleTable& table, const SampleRules& rules) {
  SampleReport report;
  markFaults(table, rules, report);
  const Census census = takeCensus(table, rules);
  std::vector<Base> bases = tryTimeBases(table, census, rules);
  report.backward = census.backward;
  report.lone = findLoneSample(table);
  const TimeBase fitting = chooseTimeBase(bases, report);
  report.time_base = rules.time_base ? fitting : TimeBase::kStamps;
  checkStamps(census, rules, report.time_base);
  Base& base = bases[static_cast<std::size_t>(report.time_base)];
  const Index used = report.time_base == TimeBase::kStamps ? census.used : census.timing.fresh;
  if (used < 2) {
    throw EvaluationError("samples", "samples",
                          "2 or more that differ and have a stamp of their own",
                          std::to_string(used), "record a motion");
  }
  report.gaps = std::move(base.gaps);
  report.longest_gap = base.longest_gap;
  Distances used_ones(table, rules, base.timing);
  report.period = used_ones.meanPeriod(rules.longest_gap);
  const double gap = kJust * gapFrom(rules.longest_gap, report.period);
  // at least half of the mean distance, as most samples of a recording may come in bursts
  report.usual_period = std::max(used_ones.median(gap), 0.5 * report.period);
  Timing all;
  all.every = true;
  SampleRules none = rules;
  none.repeated = false;
  Distances stamped(table, none, all);
  report.stamped_period = stamped.median(kInfinity);
  report.jitter = stamped.deviation(gap);

  setInstants(table, base.timing, base.pieces, rules);
  report.pieces = std::move(base.pieces);
  report.counts = census.counts;
  report.counts.start_transient = lookAtStart(table, census.timing.fresh, report.period, rules);
  markKept(table, rules, report.counts);
  return report;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
