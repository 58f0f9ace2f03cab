// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples with what the rules of samples.hpp say of each: faults, instant, whether it counts.
///
///     const Examination found = examine(stream, takeCensus(stream, rules), rules);
///     TimedSamples samples(stream, found, rules);
///     TimedBlock block;
///     while (samples.next(block)) use(block.instant, block.kept);
///
/// Two passes over the samples find out what the third one needs: how many there are and how far
/// apart; which time base fits, and where gaps are.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "distance_counts.hpp"
#include "inverse_dynamics_evaluation/samples.hpp"
#include "sample_stream.hpp"
#include "time_base.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// One truth value per sample.
using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Rules 1 and 2, sample by sample.
class FaultFinder {
 public:
  /// What it finds in the next samples.
  void examine(const SampleBlock& block, Flags& repeated, Flags& non_increasing);

  /// s; the latest stamp so far.
  double latest() const { return latest_; }

 private:
  SampleBlock last_;  // one sample
  double latest_ = 0;
};

/// What the first pass finds.
struct Census {
  Eigen::Index joints = 0;
  bool efforts = false;        ///< whether there are any
  bool accelerations = false;  ///< likewise
  bool all_zero = true;        ///< efforts
  SampleCounts counts;
  BackwardStamp backward;
  Timing timing;           ///< but for the base
  Eigen::Index used = 0;   ///< samples with a stamp of their own
  DistanceCounts stamps;   ///< ns; of neighbours
  DistanceCounts of_used;  ///< ns; of those with a stamp of their own
  DistanceCounts missed;   ///< in samples; of those that aren't repeats

  /// Mean distance of used samples [s], gaps aside.
  double period(TimeBase base, double longest_gap) const;
  /// Median of those distances [s]: a sample that was lost doesn't change it.
  double usualPeriod(TimeBase base, double gap) const;
};

/// First pass.
Census takeCensus(SampleStream& stream, const SampleRules& rules);

/// What both passes have found.
struct Examination {
  SampleReport report;  ///< without what has a number for each sample
  Timing timing;
  std::vector<Piece> pieces;  ///< of `shortest_piece` used samples or more
  double usual_period = 0;    ///< s
};

/// Second pass, and a look at the first samples.
///
/// @throws EvaluationError: see examineSamples().
Examination examine(SampleStream& stream, const Census& census, const SampleRules& rules);

/// B samples, and what the rules say of each.
struct TimedBlock : SampleBlock {
  Eigen::VectorXd instant;  ///< s; when it was taken; none is before the one before it
  Flags repeated, non_increasing, start_transient, isolated, used, kept;
};

/// What the rules say of samples in memory, gathered.
class SampleSeries {
 public:
  explicit SampleSeries(Eigen::Index count);
  void add(const TimedBlock& block);
  void moveTo(SampleReport& report);

 private:
  TimedBlock all_;  // without what was recorded
};

/// Gives a block room for `count` samples, and keeps those that have it. @param like  has the rows.
void resize(TimedBlock& block, const TimedBlock& like, Eigen::Index count);

/// Copies `count` samples from number `first` of a block to number `at` of another.
void copy(const TimedBlock& from, Eigen::Index first, Eigen::Index count, TimedBlock& to,
          Eigen::Index at);

/// Third pass, and any further one.
///
/// A repeat has the instant of the sample it repeats. One left out for its stamp lies between its
/// neighbours in the recording; of more than 16,384 such in a row, each has that of the last sample
/// before them.
class TimedSamples {
 public:
  /// Starts with the first sample. All arguments must outlive it.
  TimedSamples(SampleStream& stream, const Examination& found, const SampleRules& rules);

  /// Replaces a block by the next samples, at least one; false after the last one.
  bool next(TimedBlock& block);

 private:
  void hold();
  void mark(Eigen::Index k);
  void settle(Eigen::Index end);
  void interpolate(Eigen::Index end, double instant);
  bool give(TimedBlock& block);

  SampleStream& stream_;
  const Examination& found_;
  const SampleRules& rules_;
  FaultFinder faults_;
  TimedBlock read_;
  TimedBlock held_;            // samples that weren't given yet
  Eigen::Index known_ = 0;     // of them, those whose instant is known
  Eigen::Index fresh_ = 0;     // samples so far that aren't repeats
  Eigen::Index last_ = 0;      // number of the last sample with an instant of its own
  double last_instant_ = 0;    // s; that instant
  double instant_before_ = 0;  // s; of the last sample whose instant is known
  bool long_run_ = false;      // of samples without an instant of their own
  std::size_t piece_ = 0;      // the first one that doesn't lie before the next sample
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
