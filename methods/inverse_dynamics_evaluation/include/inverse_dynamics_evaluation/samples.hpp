// SPDX-License-Identifier: Apache-2.0

/// @file
/// Faults of recorded joint states, and the time at which each sample was really taken.
///
///     const SampleReport report = examineSamples(table);
///     table.repeated.count();                        // messages without news
///     metrics(computed, measured, table.kept);       // in addition to metrics(computed, measured)
///
/// Recordings of real robots have faults that spoil a derivative. A rule for each finds it from the
/// data alone, always reports it, and acts on it unless switched off:
///
/// 1. **Repeated samples.** q, qd and effort are, bit for bit, those of one of the eight samples
///    before: the recorder was faster than the robot, a state was late, or a second publisher repeats
///    the first. The velocity isn't zero, so the repeat is left out of the differentiation. So are
///    samples of a second publisher that stands still among those of a robot that moves, samples whose
///    positions leave the motion and return, and late ones beside repeats. Where more than one sample
///    in ten leaves the motion, two publishers move, which is an error.
/// 2. **Stamps that don't increase.** Where a clock was set, back or a little forward, the times behind
///    it are shifted: one period goes by if positions and velocities confirm that, else a gap. Any other
///    sample whose stamp isn't later than all before it is left out of the differentiation.
/// 3. **Time base.** Stamps say when a message was written, which may be later than its sample by
///    a changing amount. Positions and velocities of the samples tell which time fits:
///
///        q_(i+1) - q_i = (t_(i+1) - t_i) (qd_i + qd_(i+1)) / 2
///
///    should hold over one interval and over 50. Three time bases are compared: the stamps; samples
///    at equal distances (`kRegular`: a repeat stands for a sample that was missed); fresh samples
///    at equal distances (`kRegularFresh`: repeats are extra). One of the latter two replaces the
///    stamps if its disagreement is below 0.8 of theirs over one interval, and over 50 not more
///    than a tenth above theirs.
/// 4. **Start transient.** When a controller takes over, efforts may jump from sample to sample in
///    a way that no acceleration estimate resolves. With the second differences of the efforts
///    (divided ones, as samples may be missing), in units of their median, as a measure, everything
///    up to the last sample in the first half second that exceeds 5 times the 90 % quantile of the
///    first 65,536 samples doesn't count in the metrics over kept samples. Such samples are used in
///    the differentiation. A start transient holds at most a twentieth of the way that the joints go:
///    efforts of an arm that has begun to move are rougher than those of one that rests.
/// 5. **Gaps.** Nothing was recorded for more than 10 sampling periods. Up to a quarter of a second,
///    in which an arm's motion hardly bends more than the cubic of findAccelerations(), they are
///    bridged; at longer ones the recording is cut, and each piece filtered by itself. Pieces too
///    short to be filtered don't count.
///
/// Metrics over all samples need none of this: every sample has an acceleration. One that is left
/// out of the differentiation gets that of its instant.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Rules to act on. All of them report what they find.
struct SampleRules {
  bool repeated = true;         ///< leave repeated samples out of the differentiation
  bool non_increasing = true;   ///< leave out stamps that don't increase; else an error
  bool time_base = true;        ///< replace stamps that q and qd contradict
  bool start_transient = true;  ///< don't count the start transient in metrics over kept samples
  double start_window = 0.5;    ///< where a start transient is looked for [s]
  double longest_gap = 0.25;    ///< what may be bridged [s], or 10 sampling periods if longer
  Eigen::Index shortest_piece = 10;  ///< samples a piece between gaps must have
};

/// When samples were taken.
enum class TimeBase {
  kStamps,        ///< as stamped
  kRegular,       ///< at equal distances; a repeat stands in place of a sample that was missed
  kRegularFresh,  ///< at equal distances, repeats aside: the recorder was faster than the robot
};

/// `stamps`, `regular` or `regular_fresh`.
std::string name(TimeBase time_base);

/// Numbers of samples that the rules found.
struct SampleCounts {
  Eigen::Index all = 0;              ///< N
  Eigen::Index repeated = 0;         ///< rule 1
  Eigen::Index non_increasing = 0;   ///< rule 2
  Eigen::Index start_transient = 0;  ///< rule 4: the first ones
  Eigen::Index isolated = 0;         ///< rule 5: in pieces that are too short
  Eigen::Index kept = 0;             ///< count in metrics over kept samples
};

/// The first sample whose stamp isn't later than all before it.
struct BackwardStamp {
  Eigen::Index sample = 0;  ///< its number; 0: there is none
  std::int64_t stamp = 0;   ///< ns
  std::int64_t latest = 0;  ///< ns; the latest before it
  double time = 0;          ///< s
  double time_before = 0;   ///< s; of the sample before it
};

/// The longest gap, bridged or not.
struct LongestGap {
  Eigen::Index behind = 0;        ///< number of the first used sample behind it; 0: there is none
  double length = 0;              ///< s
  std::int64_t stamp_before = 0;  ///< ns; of the sample before that one
};

/// Samples of a second publisher among those of the robot.
struct SecondSource {
  Eigen::Index count = 0;
  Eigen::Index first = 0;  ///< number of the first one
};

/// Where a clock was set.
struct ClockStep {
  Eigen::Index sample = 0;  ///< number of the first sample behind it
  double by = 0;            ///< s; negative: back
};

/// A sample of which a joint's position or velocity leaves its neighbours by more than all other
/// samples together: by the squares of second differences. No motion does that.
struct LoneSample {
  Eigen::Index sample = 0;  ///< its number; 0: there is none
  Eigen::Index joint = 0;
  std::int64_t stamp = 0;  ///< ns
};

/// Samples between two gaps.
struct Piece {
  Eigen::Index first = 0;   ///< number of its first sample
  Eigen::Index behind = 0;  ///< of the first one that isn't in it
  Eigen::Index used = 0;    ///< how many have an instant of their own
  double begin = 0;         ///< s; of the first of those
  double end = 0;           ///< s; of the last of those
};

/// What the rules found in N samples, and what follows; the table says it of each sample.
struct SampleReport {
  SampleCounts counts;
  TimeBase time_base = TimeBase::kStamps;  ///< which one is used
  std::vector<Piece> pieces;               ///< of `shortest_piece` used samples or more
  std::vector<Eigen::Index> gaps;          ///< first used sample behind each gap that cuts (rule 5)
  LongestGap longest_gap;
  BackwardStamp backward;
  SecondSource second_source;          ///< its samples count among the repeated ones
  std::vector<ClockStep> clock_steps;  ///< that the table's time no longer has
  LoneSample lone;

  double period = 0;          ///< s; mean distance of the used samples, gaps aside
  double usual_period = 0;    ///< s; median distance of the used samples
  double stamped_period = 0;  ///< s; median distance of the stamps
  double jitter = 0;          ///< s; root mean square of that distance's deviation from its mean

  /// Disagreement of q and qd over one interval, root mean square over samples and sum over joints
  /// [rad], under each time base (in the order of TimeBase); NaN if it wasn't compared.
  Eigen::Vector3d disagreement;
  Eigen::Vector3d long_disagreement;  ///< the same over 50 intervals
};

/// Applies the rules above: fills the table's flags and instants, takes steps of the clock out of its time. O(N).
///
/// A repeat has the instant of the last sample before that isn't one; one left out for its stamp lies between its
/// neighbours in the recording. Without efforts, repeats are found by q and qd, and no start
/// transient is looked for.
///
/// @throws EvaluationError: fewer than 2 samples; two publishers that both move; stamps that don't
///         increase where that rule is off, or for more than half of the samples.
SampleReport examineSamples(SampleTable& table, const SampleRules& rules = {});

/// Makes positions of continuous joints go on where they jump by a turn from one sample to the next.
///
/// Such jumps of revolute joints stay as they are. Nothing changes if there are other joints than
/// types: that is refused elsewhere.
///
/// @param joint_names  for the texts.
/// @return a sentence for each revolute joint that jumps.
std::vector<std::string> unwrapPositions(SampleTable& table,
                                         const std::vector<chain_dynamics::JointType>& types,
                                         const std::vector<std::string>& joint_names);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
