// SPDX-License-Identifier: Apache-2.0

/// @file
/// When samples were taken: rule 3 of samples.hpp, and what gaps are.

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What is longer than this is a gap [s]: `longest_gap`, or 20 sampling periods if that is more.
double gapFrom(double longest_gap, double period);

/// When each sample was taken, under a time base.
struct Timing {
  TimeBase base = TimeBase::kStamps;
  Eigen::Index count = 0;  ///< N; samples
  Eigen::Index fresh = 0;  ///< of them, without repeats that are left out
  double begin = 0;        ///< s; first stamp
  double duration = 0;     ///< s; from there to the latest stamp

  /// s; of sample `k`, which is fresh sample number `i`.
  double operator()(Eigen::Index k, Eigen::Index i, double stamp) const;

  /// Whether a fresh sample has an instant of its own.
  bool uses(bool non_increasing) const { return base != TimeBase::kStamps || !non_increasing; }

  /// s; between neighbours at equal distances.
  double step() const;
};

/// Samples between two gaps.
struct Piece {
  Eigen::Index first = 0;   ///< number of its first sample
  Eigen::Index behind = 0;  ///< of the first one that isn't in it
  Eigen::Index used = 0;    ///< how many have an instant of their own
  double begin = 0;         ///< s; of the first of those
  double end = 0;           ///< s; of the last of those
};

/// What a time base makes of the samples: how well q and qd agree with it, and pieces between gaps.
class TimeBaseSums {
 public:
  /// @param gap       s; what is longer is one.
  /// @param used      how many samples have an instant of their own.
  /// @param shortest  samples that a piece must have.
  TimeBaseSums(const Timing& timing, double gap, Eigen::Index used, Eigen::Index shortest,
               Eigen::Index joints);

  /// The next sample with an instant of its own.
  ///
  /// @param q,qd          n.
  /// @param stamp_before  ns; of the sample before it in the recording.
  void add(Eigen::Index k, double time, const double* q, const double* qd,
           std::int64_t stamp_before);

  /// Root mean square of q_(i+m) - q_i - sum of (t_(i+1) - t_i) (qd_i + qd_(i+1)) / 2 over blocks
  /// of m intervals; intervals over a gap are left out. NaN if there is none.
  double disagreement() const { return short_.rms(); }     ///< m = 1
  double longDisagreement() const { return long_.rms(); }  ///< m = 50

  /// There is no further sample.
  void finish();

  const std::vector<Piece>& pieces() const { return pieces_; }
  const std::vector<Eigen::Index>& gaps() const { return gaps_; }
  const LongestGap& longestGap() const { return longest_gap_; }
  const Timing& timing() const { return timing_; }

 private:
  struct Disagreement {
    void add(const Eigen::ArrayXd& error);
    double rms() const;
    Eigen::Index intervals;  // m
    Eigen::ArrayXd error{};
    double sum = 0;
    Eigen::Index added = 0, blocks = 0;
  };

  void endPiece(Eigen::Index behind);

  Timing timing_;
  double gap_;
  Disagreement short_, long_;
  Eigen::ArrayXd q_, qd_, error_;  // of the sample before, which was used
  double time_ = 0;                // of it
  Eigen::Index shortest_;
  Piece piece_;  // the one that hasn't ended
  std::vector<Piece> pieces_;
  std::vector<Eigen::Index> gaps_;
  LongestGap longest_gap_;
};

/// Which time base q and qd agree with; writes what they say.
///
/// @param bases  of each TimeBase, in its order.
TimeBase chooseTimeBase(const std::vector<TimeBaseSums>& bases, SampleReport& report);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
