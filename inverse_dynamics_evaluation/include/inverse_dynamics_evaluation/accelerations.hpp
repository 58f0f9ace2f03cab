// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joint accelerations of recorded joint states, which no robot measures.
///
///     Eigen::MatrixXd raw = backwardDifference(time, qd);
///     AccelerationEstimate good = lowPassAccelerations(time, q, qd, effort);
///     std::cout << good.filter.cutoff << " Hz, mean torque error "
///               << metrics(solver->getTorquesBatch(q, qd, good.qdd), effort)[0].rmse << " N m\n";
///
/// Backward differences are what the reference implementation takes: unbiased but for half a
/// sample, and as noisy as velocity noise times sqrt(2) over the sampling period. At 1 kHz that is
/// worse than no acceleration at all. lowPassAccelerations() filters before it differentiates, with
/// a cut-off from the data. Only accelerations come from the filter; q and qd stay as measured.

#pragma once

#include <Eigen/Core>
#include <string>

#include "inverse_dynamics_evaluation/cutoff.hpp"
#include "inverse_dynamics_evaluation/low_pass.hpp"
#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Accelerations by backward differences: `qdd_i = (qd_i - qd_(i-1)) / (t_i - t_(i-1))`.
///
/// The method of the reference implementation: the first sample is zero, and so is every sample
/// whose stamp isn't later than the one before. No filter, no rule of samples.hpp.
///
/// @param time  N; s.
/// @param qd    n x N, one sample per column; rad/s (prismatic m/s).
/// @return n x N; rad/s^2 (prismatic m/s^2).
/// @throws EvaluationError: sizes differ, no sample, a number that isn't finite.
OwnedMatrix backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                               const Eigen::Ref<const Eigen::MatrixXd>& qd);

/// Derivative of equidistant samples after the zero-phase low-pass of low_pass.hpp.
///
/// Before the filter both ends are continued by cubics through the last 1.2 periods of the cut-off,
/// so the derivative at the ends is about as good as samples of one side allow: better than with
/// the point reflection of lowPass(), which turns the noise of the last sample into a step.
///
/// @param samples             n x N, one sample per column.
/// @param sampling_frequency  Hz.
/// @param cutoff              Hz, below half the sampling frequency; gain one half there.
/// @param order               of the Butterworth filter that runs twice; 1 to 12.
/// @return n x N.
/// @throws EvaluationError as lowPass() does.
OwnedMatrix lowPassDerivative(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                              double sampling_frequency, double cutoff, int order = 2);

/// How lowPassAccelerations() is to work.
struct LowPassOptions {
  double cutoff = 0;  ///< Hz; 0: chosen from the data
  int order = 2;      ///< of the Butterworth filter that runs forwards and backwards
  SampleRules rules;  ///< which faults of the samples are acted upon
};

/// What a filter did: to be printed and stored beside its result.
struct FilterChoice {
  std::string method;                      ///< in words
  double cutoff = 0;                       ///< Hz; gain one half there
  bool chosen = false;                     ///< whether the cut-off was chosen from the data
  CutoffChoice choice;                     ///< how; all zero if it wasn't
  int order = 0;                           ///< of the Butterworth filter; forwards and backwards
  double sampling_frequency = 0;           ///< Hz; of the equidistant samples that were filtered
  TimeBase time_base = TimeBase::kStamps;  ///< when samples were taken
  Eigen::Index pieces = 0;                 ///< filtered one by one, between gaps
};

/// Accelerations, how they came about, and what was found in the samples.
struct AccelerationEstimate {
  OwnedMatrix qdd;       ///< n x N; rad/s^2 (prismatic m/s^2)
  FilterChoice filter;   ///< what the filter did
  SampleReport samples;  ///< what was found; `samples.kept` is for the second metrics
};

/// Accelerations by a zero-phase low-pass of the velocities, then their derivative. O(N log N).
///
/// The used samples of examineSamples() are interpolated to equidistant ones at the median sampling
/// period (at least half of the mean one), by cubics through four neighbours or, where two of these
/// are closer than half a period or more than three apart, by a straight line; low-passed,
/// differentiated, and interpolated back to the instants of all N samples. A sample that wasn't used
/// gets the acceleration of its instant.
///
/// @param time    N; s; stamps.
/// @param q       n x N, one sample per column; rad (prismatic m).
/// @param qd      n x N; rad/s (prismatic m/s).
/// @param effort  n x N; N m (prismatic N), or empty (0 x 0); for rules 1 and 4 of samples.hpp
/// only.
/// @throws EvaluationError as examineSamples(), lowPass() and chooseCutoff() do; fewer than 16 used
///         samples in every piece.
AccelerationEstimate lowPassAccelerations(const Eigen::Ref<const Eigen::VectorXd>& time,
                                          const Eigen::Ref<const Eigen::MatrixXd>& q,
                                          const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                          const Eigen::Ref<const Eigen::MatrixXd>& effort,
                                          const LowPassOptions& options = {});

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
