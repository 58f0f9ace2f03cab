// SPDX-License-Identifier: Apache-2.0

#include "timed_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "start_transient.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNanosecond = 1e-9;
constexpr Index kLongestRun = 16384;  // of samples that wait for an instant

std::int64_t nanoseconds(double seconds) {
  constexpr double kMost = 9e18;
  return std::llround(std::clamp(seconds / kNanosecond, -kMost, kMost));
}

// The one column of `last`, then all but the last of `block`, compared with the block.
Flags sameAsBefore(const MatrixXd& last, const MatrixXd& block) {
  Flags same(block.cols());
  for (Index k = 0; k < block.cols(); ++k) {
    const double* before = k > 0 ? block.col(k - 1).data() : last.data();
    same[k] = (k > 0 || last.size() > 0) &&
              std::equal(before, before + block.rows(), block.col(k).data());
  }
  return same;
}

// Calls `visit` with each member of a block that has a number, or a column, for each sample.
template <class Visit>
void forEachSeries(Visit visit) {
  visit(&TimedBlock::header_stamps), visit(&TimedBlock::receive_stamps), visit(&TimedBlock::time);
  visit(&TimedBlock::q), visit(&TimedBlock::qd), visit(&TimedBlock::effort);
  visit(&TimedBlock::qdd), visit(&TimedBlock::instant), visit(&TimedBlock::repeated);
  visit(&TimedBlock::non_increasing), visit(&TimedBlock::start_transient);
  visit(&TimedBlock::isolated), visit(&TimedBlock::used), visit(&TimedBlock::kept);
}

}  // namespace

void resize(TimedBlock& block, const TimedBlock& like, Index count) {
  forEachSeries([&](auto member) {
    auto& series = block.*member;
    if constexpr (std::decay_t<decltype(series)>::ColsAtCompileTime == 1) {
      series.conservativeResize(count);
    } else {
      const Index rows = (like.*member).rows();
      series.conservativeResize(rows, rows > 0 ? count : 0);
    }
  });
}

void copy(const TimedBlock& from, Index first, Index count, TimedBlock& to, Index at) {
  forEachSeries([&](auto member) {
    auto& series = to.*member;
    if constexpr (std::decay_t<decltype(series)>::ColsAtCompileTime == 1) {
      series.segment(at, count) = (from.*member).segment(first, count);
    } else if (series.size() > 0) {
      series.middleCols(at, count) = (from.*member).middleCols(first, count);
    }
  });
}

void FaultFinder::examine(const SampleBlock& block, Flags& repeated, Flags& non_increasing) {
  const Index count = block.size();
  repeated = sameAsBefore(last_.q, block.q) && sameAsBefore(last_.qd, block.qd);
  if (block.effort.size() > 0) {
    repeated = repeated && sameAsBefore(last_.effort, block.effort);
  }
  non_increasing.resize(count);
  for (Index k = 0; k < count; ++k) {
    // a robot at rest may well say the same twice
    repeated[k] = repeated[k] && !block.qd.col(k).isZero(0);
    const bool first = k == 0 && last_.q.size() == 0;
    non_increasing[k] = !first && !(block.time[k] > latest_);
    latest_ = first ? block.time[k] : std::max(latest_, block.time[k]);
  }
  last_.q = block.q.rightCols(1);
  last_.qd = block.qd.rightCols(1);
  if (block.effort.size() > 0) {
    last_.effort = block.effort.rightCols(1);
  }
}

double Census::period(TimeBase base, double longest_gap) const {
  Timing regular = timing;
  regular.base = base;
  switch (base) {
    case TimeBase::kStamps:
      return meanPeriod(of_used, kNanosecond, longest_gap);
    case TimeBase::kRegular:
      return meanPeriod(missed, regular.step(), longest_gap);
    case TimeBase::kRegularFresh:
      break;
  }
  return regular.step();
}

double Census::usualPeriod(TimeBase base, double gap) const {
  Timing regular = timing;
  regular.base = base;
  switch (base) {
    case TimeBase::kStamps:
      return kNanosecond * of_used.quantile(0.5, gap / kNanosecond);
    case TimeBase::kRegular:
      return regular.step() * missed.quantile(0.5, gap / regular.step());
    case TimeBase::kRegularFresh:
      break;
  }
  return regular.step();
}

namespace {

// Adds samples to a census, one after another.
class CensusTaker {
 public:
  CensusTaker(Census& census, const SampleRules& rules) : census_(census), rules_(rules) {}

  void add(const SampleBlock& block, const SampleBlock::StampVector& stamps) {
    faults_.examine(block, repeated_, non_increasing_);
    if (census_.counts.all == 0) {
      census_.joints = block.q.rows();
      census_.efforts = block.effort.size() > 0;
      census_.accelerations = block.qdd.size() > 0;
      census_.timing.begin = block.time[0];
    }
    census_.all_zero = census_.all_zero && block.effort.isZero(0);
    for (Index k = 0; k < block.size(); ++k) {
      lookBack(block.first + k, block.time[k], stamps[k], non_increasing_[k]);
      census_.counts.repeated += repeated_[k] ? 1 : 0;
      if (!(rules_.repeated && repeated_[k])) {
        addFresh(block.first + k, block.time[k], non_increasing_[k]);
      }
    }
    census_.counts.all += block.size();
  }

  // s; the latest stamp so far.
  double latest() const { return faults_.latest(); }

 private:
  // How far a sample is from the one before it.
  void lookBack(Index number, double time, std::int64_t stamp, bool non_increasing) {
    if (number > 0) {
      census_.stamps.add(nanoseconds(time - before_));
    }
    if (non_increasing && census_.counts.non_increasing++ == 0) {
      census_.backward = {number, stamp, census_.backward.latest, time, before_};
    } else if (census_.counts.non_increasing == 0) {
      census_.backward.latest = stamp;  // all have increased so far
    }
    before_ = time;
  }

  // A sample that doesn't repeat the one before it.
  void addFresh(Index number, double time, bool non_increasing) {
    if (census_.timing.fresh++ > 0) {
      census_.missed.add(number - last_fresh_);
    }
    last_fresh_ = number;
    if (!non_increasing) {
      if (census_.used++ > 0) {
        census_.of_used.add(nanoseconds(time - last_used_));
      }
      last_used_ = time;
    }
  }

  Census& census_;
  const SampleRules& rules_;
  FaultFinder faults_;
  Flags repeated_, non_increasing_;
  Index last_fresh_ = 0;
  double last_used_ = 0;  // s
  double before_ = 0;     // s; of the sample before
};

}  // namespace

Census takeCensus(SampleStream& stream, const SampleRules& rules) {
  Census census;
  CensusTaker taker(census, rules);
  SampleBlock block;
  stream.rewind();
  while (stream.next(block)) {
    taker.add(block,
              stream.clock() == Clock::kReceive ? block.receive_stamps : block.header_stamps);
  }
  census.timing.count = census.counts.all;
  census.timing.duration = taker.latest() - census.timing.begin;
  return census;
}

namespace {

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

// Second pass: what each time base makes of the samples.
std::vector<TimeBaseSums> sumsOfBases(SampleStream& stream, const Census& census,
                                      const SampleRules& rules) {
  std::vector<TimeBaseSums> bases;
  for (const TimeBase base : {TimeBase::kStamps, TimeBase::kRegular, TimeBase::kRegularFresh}) {
    Timing timing = census.timing;
    timing.base = base;
    bases.emplace_back(timing, gapFrom(rules.longest_gap, census.period(base, rules.longest_gap)),
                       base == TimeBase::kStamps ? census.used : census.timing.fresh,
                       rules.shortest_piece, census.joints);
  }
  FaultFinder faults;
  SampleBlock block;
  Flags repeated;
  Flags non_increasing;
  Index fresh = 0;
  std::int64_t before = 0;
  stream.rewind();
  while (stream.next(block)) {
    const SampleBlock::StampVector& stamps =
        stream.clock() == Clock::kReceive ? block.receive_stamps : block.header_stamps;
    faults.examine(block, repeated, non_increasing);
    for (Index k = 0; k < block.size(); ++k) {
      if (!(rules.repeated && repeated[k])) {
        const Index number = block.first + k;
        for (TimeBaseSums& base : bases) {
          if (base.timing().uses(non_increasing[k])) {
            base.add(number, base.timing()(number, fresh, block.time[k]), block.q.col(k).data(),
                     block.qd.col(k).data(), before);
          }
        }
        ++fresh;
      }
      before = stamps[k];
    }
  }
  for (TimeBaseSums& base : bases) {
    base.finish();
  }
  return bases;
}

// Rule 4: which samples are a start transient, and which are kept.
void lookAtStart(SampleStream& stream, const Census& census, const SampleRules& rules,
                 Examination& found) {
  SampleCounts& counts = found.report.counts;
  for (const Piece& piece : found.pieces) {
    counts.kept += piece.used;
    counts.isolated -= piece.behind - piece.first;
  }
  counts.isolated += counts.all;
  if (!census.efforts) {
    return;
  }
  const Index most = std::min(census.timing.fresh, kMostForTransient);
  MatrixXd effort(census.joints, most);
  VectorXd instant(most);
  std::vector<Index> number;
  std::vector<bool> used;
  TimedSamples samples(stream, found, rules);
  TimedBlock block;
  while (static_cast<Index>(number.size()) < most && samples.next(block)) {
    for (Index k = 0; k < block.size() && static_cast<Index>(number.size()) < most; ++k) {
      if (!(rules.repeated && block.repeated[k])) {
        const auto i = static_cast<Index>(number.size());
        effort.col(i) = block.effort.col(k);
        instant[i] = block.instant[k];
        number.push_back(block.first + k);
        used.push_back(block.used[k]);
      }
    }
  }
  const Index end = startTransient(effort, instant, found.report.period, rules.start_window);
  counts.start_transient = end > 0 ? number[static_cast<std::size_t>(end - 1)] + 1 : 0;
  if (rules.start_transient) {
    counts.kept -= std::count(used.begin(), used.begin() + end, true);
  }
}

}  // namespace

Examination examine(SampleStream& stream, const Census& census, const SampleRules& rules) {
  const std::vector<TimeBaseSums> bases = sumsOfBases(stream, census, rules);
  Examination found;
  SampleReport& report = found.report;
  report.counts = census.counts;
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
  found.timing = base.timing();
  found.pieces = base.pieces();
  for (const Piece& piece : found.pieces) {
    report.pieces.push_back(piece.first);
  }
  report.gaps = base.gaps();
  report.longest_gap = base.longestGap();
  report.period = census.period(report.time_base, rules.longest_gap);
  const double gap = gapFrom(rules.longest_gap, report.period);
  // at least half of the mean distance, as most samples of a recording may come in bursts
  found.usual_period = std::max(census.usualPeriod(report.time_base, gap), 0.5 * report.period);
  report.stamped_period =
      kNanosecond * census.stamps.quantile(0.5, std::numeric_limits<double>::infinity());
  report.jitter = kNanosecond * census.stamps.deviation(gap / kNanosecond);
  lookAtStart(stream, census, rules, found);
  return found;
}

TimedSamples::TimedSamples(SampleStream& stream, const Examination& found, const SampleRules& rules)
    : stream_(stream), found_(found), rules_(rules) {
  stream_.rewind();
}

SampleSeries::SampleSeries(Index count) {
  for (Flags* flags : {&all_.repeated, &all_.non_increasing, &all_.start_transient, &all_.isolated,
                       &all_.used, &all_.kept}) {
    flags->resize(count);
  }
  all_.instant.resize(count);
}

void SampleSeries::add(const TimedBlock& block) {
  for (Flags TimedBlock::*const flags :
       {&TimedBlock::repeated, &TimedBlock::non_increasing, &TimedBlock::start_transient,
        &TimedBlock::isolated, &TimedBlock::used, &TimedBlock::kept}) {
    (all_.*flags).segment(block.first, block.size()) = block.*flags;
  }
  all_.instant.segment(block.first, block.size()) = block.instant;
}

void SampleSeries::moveTo(SampleReport& report) {
  report.repeated = all_.repeated;
  report.non_increasing = all_.non_increasing;
  report.start_transient = all_.start_transient;
  report.isolated = all_.isolated;
  report.used = all_.used;
  report.kept = all_.kept;
  report.time = all_.instant;
}

bool TimedSamples::next(TimedBlock& block) {
  while (known_ == 0) {
    if (!stream_.next(read_)) {
      settle(held_.size());
      return held_.size() > 0 && give(block);
    }
    hold();
  }
  return give(block);
}

// Puts what was read behind the samples that are held.
void TimedSamples::hold() {
  faults_.examine(read_, read_.repeated, read_.non_increasing);
  const Index more = read_.size();
  read_.instant.resize(more);
  for (Flags* flags : {&read_.start_transient, &read_.isolated, &read_.used, &read_.kept}) {
    flags->setZero(more);
  }
  const Index from = held_.size();
  if (from == 0) {
    std::swap(held_, read_);
  } else {
    resize(held_, read_, from + more);
    copy(read_, 0, more, held_, from);
  }
  for (Index k = from; k < from + more; ++k) {
    mark(k);
  }
}

// What the rules say of a sample.
void TimedSamples::mark(Index k) {
  const Index number = held_.first + k;
  while (piece_ < found_.pieces.size() && found_.pieces[piece_].behind <= number) {
    ++piece_;
  }
  const bool left_out = rules_.repeated && held_.repeated[k];
  const bool own = !left_out && found_.timing.uses(held_.non_increasing[k]);
  held_.isolated[k] = piece_ == found_.pieces.size() || number < found_.pieces[piece_].first;
  held_.start_transient[k] = number < found_.report.counts.start_transient;
  held_.used[k] = own && !held_.isolated[k];
  held_.kept[k] = held_.used[k] && !(rules_.start_transient && held_.start_transient[k]);
  if (own) {
    const double instant = found_.timing(number, fresh_, held_.time[k]);
    interpolate(k, instant);
    held_.instant[k] = instant_before_ = last_instant_ = instant;
    last_ = number;
    known_ = k + 1;
    long_run_ = false;
  } else if (long_run_ || k - known_ == kLongestRun || (left_out && known_ == k)) {
    long_run_ = long_run_ || k - known_ == kLongestRun;
    settle(k + 1);
  }
  fresh_ += left_out ? 0 : 1;
}

// Instants of those that wait, up to the one before `end`: that of the sample before them.
void TimedSamples::settle(Index end) {
  held_.instant.segment(known_, end - known_).setConstant(instant_before_);
  known_ = end;
}

// Instants of those that wait, between those of their neighbours.
void TimedSamples::interpolate(Index end, double instant) {
  const auto before = static_cast<double>(last_);
  const auto after = static_cast<double>(held_.first + end);
  for (; known_ < end; ++known_) {
    if (!(rules_.repeated && held_.repeated[known_])) {
      const double share = (static_cast<double>(held_.first + known_) - before) / (after - before);
      instant_before_ = last_instant_ + share * (instant - last_instant_);
    }
    held_.instant[known_] = instant_before_;
  }
}

// Gives the samples whose instants are known.
bool TimedSamples::give(TimedBlock& block) {
  const Index rest = held_.size() - known_;
  if (rest == 0) {
    std::swap(block, held_);
    resize(held_, held_, 0);
  } else {
    block.first = held_.first;
    resize(block, held_, known_);
    copy(held_, 0, known_, block, 0);
    TimedBlock kept;
    kept.first = held_.first + known_;
    resize(kept, held_, rest);
    copy(held_, known_, rest, kept, 0);
    held_ = std::move(kept);
  }
  known_ = 0;
  return true;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
