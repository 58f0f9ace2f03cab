// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joint accelerations of recorded joint states, which no robot measures.
///
///     Eigen::MatrixXd raw = backwardDifference(time, qd);
///     const auto table = tableOf(time, q, qd, effort);
///     const AccelerationReport good = findAccelerations(*table, AccelerationMethod::kLowPass);
///     std::cout << good.filter.cutoff << " Hz, mean torque error "
///               << metrics(solver->getTorquesBatch(q, qd, table->qdd), effort)[0].rmse << " N m\n";
///
/// The reference implementation takes backward differences: unbiased but for half a sample, and as
/// noisy as velocity noise times sqrt(2) over the sampling period. At 1 kHz that is
/// worse than no acceleration at all. findAccelerations() filters before it differentiates, with a
/// cut-off from the data. Only accelerations come from the filter; q and qd stay as measured.
///
/// The filter is a Butterworth filter of order m, over equidistant samples. It passes a sine of
/// frequency f with the power
///
///     |B(f)|^2 = 1 / (1 + (w / w_c)^(2 m)),   w = tan(pi f / f_s),   w_c = tan(pi f_c / f_s),
///
/// (f_s sampling frequency, f_c cut-off; the tangent is what the bilinear transformation does to
/// frequencies) and delays it. Run once more over the result backwards in time, it takes the delay
/// back and attenuates again. What remains is the real gain |B(f)|^2, one half at the cut-off, with
/// no delay at any frequency (zero phase). That needs the future: it is for recordings only.

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/cutoff.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"
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

/// Gain of the zero-phase low-pass, forwards and backwards, at a frequency: `|B(f)|^2`.
///
/// @param frequency,cutoff,sampling_frequency  Hz; 0 < cutoff < sampling_frequency / 2.
double lowPassGain(double frequency, double cutoff, double sampling_frequency, int order = 2);

/// Default number of samples by which lowPass() continues each end: one and a half periods of the
/// cut-off, at least 3 (order + 1) samples, at most N - 1.
Eigen::Index defaultPadding(Eigen::Index samples, double sampling_frequency, double cutoff,
                            int order = 2);

/// Each row of `samples`, zero-phase low-passed. O(n N).
///
/// The samples are continued beyond both ends by their point reflection, 2 x_0 - x_k. The filter
/// starts in the steady state of the first value, so a constant passes unchanged. The result is
/// that of scipy.signal.sosfiltfilt with the same `padlen`.
///
/// @param samples             n x N, one sample per column, at equal distances in time.
/// @param sampling_frequency  Hz.
/// @param cutoff              Hz, below half the sampling frequency; gain one half there.
/// @param order               of the Butterworth filter that runs twice; 1 to 12.
/// @param padding             samples by which each end is continued, below N; negative: default.
/// @throws EvaluationError: cut-off, order or padding out of range; fewer than 3 (order + 1) + 1
///         samples; a number that isn't finite (joint and sample are named).
OwnedMatrix lowPass(const Eigen::Ref<const Eigen::MatrixXd>& samples, double sampling_frequency,
                    double cutoff, int order = 2, Eigen::Index padding = -1);

/// Options of findAccelerations().
struct LowPassOptions {
  double cutoff = 0;  ///< Hz; 0: chosen from the data
  int order = 2;      ///< of the Butterworth filter that runs forwards and backwards
  SampleRules rules;  ///< faults of the samples to act on
  /// Of the robot: recorded efforts choose the cut-off, too. Null: positions and velocities alone do.
  const inverse_dynamics_solver::InverseDynamicsSolver* solver = nullptr;
};

/// Properties of a filter, printed and stored with its result.
struct FilterChoice {
  std::string method;                      ///< in words
  double cutoff = 0;                       ///< Hz; gain one half there
  bool chosen = false;                     ///< whether the cut-off was chosen from the data
  CutoffChoice choice;                     ///< bounds of the choice; all zero if not chosen
  int order = 0;                           ///< of the Butterworth filter; forwards and backwards
  double sampling_frequency = 0;           ///< Hz; of the equidistant samples that were filtered
  TimeBase time_base = TimeBase::kStamps;  ///< when samples were taken
  Eigen::Index pieces = 0;                 ///< filtered one by one, between gaps
};

/// Where accelerations come from.
enum class AccelerationMethod {
  kAuto,                ///< those recorded, if there are any; else kLowPass
  kLowPass,             ///< zero-phase low-pass of the velocities, then their derivative
  kBackwardDifference,  ///< backward differences; no filter
  kGiven,               ///< those recorded
};

/// `auto`, `low-pass`, `backward-difference` or `given`.
std::string name(AccelerationMethod method);

/// The method of that name. @throws EvaluationError: another text.
AccelerationMethod accelerationMethod(const std::string& name);

/// Origin of accelerations, and findings about the samples.
struct AccelerationReport {
  AccelerationMethod method = AccelerationMethod::kLowPass;  ///< the one taken; not kAuto
  FilterChoice filter;                ///< what the low-pass did; all zero where there was none
  std::string summary;                ///< their origin, in words
  SampleReport samples;               ///< what was found
  std::vector<std::string> findings;  ///< about the samples, a sentence each
};

/// Fills accelerations, instants and flags of a table. O(N log N).
///
/// kLowPass: the used samples of examineSamples() are interpolated to equidistant ones at the median
/// sampling period (at least half of the mean one), by cubics through four neighbours (across holes,
/// wider ones) or, where two of these are closer than half a period, by a straight line; low-passed,
/// differentiated, and interpolated back to the instants of all N samples. A sample that wasn't used
/// gets the acceleration of its instant.
///
/// @throws EvaluationError: as examineSamples() and lowPass() do; fewer than 16 used samples in every
///         piece; a cut-off for a method that has none; kGiven where none are recorded.
AccelerationReport findAccelerations(SampleTable& table, AccelerationMethod method,
                                     LowPassOptions options = {});

/// Origin of accelerations in words, for titles and tables.
///
/// @param cutoff  Hz; of the low-pass. @param chosen  whether it was chosen from the data.
std::string accelerationSummary(AccelerationMethod method, double cutoff, bool chosen);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
