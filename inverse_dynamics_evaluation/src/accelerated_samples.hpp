// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples with their accelerations, by passes over a stream of samples.
///
///     const AccelerationPlan plan = planAccelerations(stream, method, 0.0, 2, rules);
///     AcceleratedSamples samples(stream, plan);
///     TimedBlock block;
///     while (samples.next(block)) use(block.q, block.qd, block.qdd);
///
/// Kept in memory: some blocks of samples, some periods of the cut-off, and some numbers per gap.

#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <vector>

#include "inverse_dynamics_evaluation/log_accelerations.hpp"
#include "low_pass_differentiator.hpp"
#include "resampler.hpp"
#include "timed_samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// How accelerations are estimated, and what that needs to know of all samples.
struct AccelerationPlan {
  AccelerationMethod method = AccelerationMethod::kLowPass;  ///< not kAuto
  SampleRules rules;
  Census census;
  Examination found;
  FilterChoice filter;      ///< of the low-pass
  std::vector<Grid> grids;  ///< likewise; of each piece
};

/// What is asked for, see logAccelerations().
struct AccelerationOptions {
  AccelerationMethod method = AccelerationMethod::kAuto;
  double cutoff = 0;  ///< Hz; 0: chosen from the data
  int order = LowPassOptions().order;
  SampleRules rules;
};

/// Refuses stamps, positions, velocities, efforts or accelerations of different lengths, and fewer
/// than two samples. @throws EvaluationError
void checkLog(const JointLogView& log);

/// Refuses a cut-off [Hz] that no filter has, or for a method that has none; 0: chosen from the data.
/// @throws EvaluationError
void checkCutoff(AccelerationMethod method, double cutoff);

/// The passes that accelerations need before they are computed.
///
/// @throws EvaluationError: see logAccelerations().
AccelerationPlan planAccelerations(SampleStream& stream, const AccelerationOptions& options);

/// Accelerations of samples that come in order, from those of equidistant samples that come in
/// order: on straight lines between them, and between two pieces.
class Interpolation {
 public:
  /// @param grids  of the pieces; must outlive it.
  Interpolation(const std::vector<Grid>& grids, Eigen::Index joints);

  /// The next accelerations of equidistant samples of all pieces.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& accelerations);

  /// Computes the acceleration at an instant, if enough is known: instants don't decrease.
  bool at(double instant, Eigen::Ref<Eigen::VectorXd> acceleration);

 private:
  const std::vector<Grid>& grids_;
  Eigen::MatrixXd known_;   // with room for more than count_
  Eigen::Index first_ = 0;  // number of the first one, over all pieces
  Eigen::Index count_ = 0;
  std::size_t piece_ = 0;         // the last one that has begun
  Eigen::Index piece_first_ = 0;  // number of its first one
};

/// The last pass.
class AcceleratedSamples {
 public:
  /// Starts with the first sample. Both arguments must outlive it.
  AcceleratedSamples(SampleStream& stream, const AccelerationPlan& plan);

  /// Replaces a block by the next kSamplesAtOnce samples, the last ones may be fewer; false after
  /// the last one.
  bool next(TimedBlock& block);

 private:
  void read();
  void differentiate(TimedBlock& block);
  void filter(const TimedBlock& block);
  void startPiece();
  void interpolate();

  SampleStream& stream_;
  const AccelerationPlan& plan_;
  TimedSamples samples_;
  bool ended_ = false;
  Eigen::Index read_ = 0;           // samples
  std::deque<TimedBlock> waiting_;  // with samples that weren't given yet
  Eigen::Index given_ = 0;          // samples of the first of these blocks that were
  Eigen::Index known_ = 0;          // samples that wait and have their acceleration
  std::size_t block_ = 0;           // block, and sample in it,
  Eigen::Index in_block_ = 0;       // of the first one that hasn't
  Eigen::VectorXd last_qd_;         // of the sample before, for backward differences
  double last_time_ = 0;            // s; likewise
  Interpolation interpolation_;     // for the low-pass, as all below
  std::size_t piece_ = 0;           // the one whose samples come
  std::unique_ptr<LowPassDifferentiator> differentiator_;
  std::unique_ptr<Resampler> resampler_;
};

/// Accelerations of samples in memory, n x N; the plan's report gets what the rules say of each.
OwnedMatrix gatherAccelerations(SampleStream& stream, AccelerationPlan& plan);

/// What a plan says, but for what has a number for each sample and isn't in the plan's report.
LogAccelerations withoutSeries(const SampleStream& stream, const AccelerationPlan& plan);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
