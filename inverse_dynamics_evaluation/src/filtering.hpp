// SPDX-License-Identifier: Apache-2.0

/// @file
/// The filter of accelerations.hpp in place, and accelerations of a table.
///
///     const AccelerationReport found = findAccelerations(table, method, options);
///     table.qdd.col(k);

#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What a filter of this order needs, of which each end is continued.
constexpr Eigen::Index leastSamples(int order) { return 3 * (order + 1) + 1; }

/// @throws EvaluationError: sampling frequency, cut-off or order out of range.
void requireFilter(double sampling_frequency, double cutoff, int order);

/// Butterworth filter forwards, then backwards, of each row; starts in the steady state of the first
/// value at either end.
///
/// @param cutoff_over_sampling  0 to 0.5; gain one half there.
/// @param order                 1 to 12.
void zeroPhase(Eigen::Ref<Eigen::MatrixXd> samples, double cutoff_over_sampling, int order);

/// Samples without which an end can't be continued, if there are as many.
constexpr Eigen::Index kLeastFit = 6;

/// Continuation of each row beyond its first sample, by the cubic that fits the samples best there.
///
/// The point reflection of lowPass() keeps value and slope, but the noise of the last sample becomes
/// a step of twice its size, and the curvature changes its sign. A cubic averages the noise and goes
/// on with slope and curvature. docs/accuracy.md has the errors at the ends.
///
/// @param samples  n x N, equidistant, N >= 4; the first one is the end, so for the end of a
///                 recording time is counted backwards. Weights fall from one at the first sample
///                 to zero behind the last (cos^2 of the amplitude).
/// @param count    samples by which the end is continued.
/// @return n x count; the nearest first.
Eigen::MatrixXd beyondEnd(const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index count);

/// Room for samples and their continuation beyond both ends: cubics, then point reflections.
///
///     const DerivativeRoom room(count, 125.0, 2.0, 2);
///     Eigen::MatrixXd columns(6, room.size());
///     columns.middleCols(room.begin(), count) = qd;
///     const auto qdd = room.differentiate(columns);   // where they lie: nothing is copied
struct DerivativeRoom {
  /// @param samples  how many there are.
  DerivativeRoom(Eigen::Index samples, double frequency, double cutoff_frequency, int filter_order);

  /// Columns that the room has.
  Eigen::Index size() const { return count + 2 * begin(); }
  /// Number of the first sample's column.
  Eigen::Index begin() const { return mirror + beyond; }

  /// Derivatives [1/s] of the samples, zero-phase low-passed.
  ///
  /// @param room  n x size(), samples in their columns; lost afterwards.
  /// @return n x count columns of the room.
  Eigen::Ref<Eigen::MatrixXd> differentiate(Eigen::Ref<Eigen::MatrixXd> room) const;

  Eigen::Index count;
  double sampling_frequency, cutoff;  // Hz
  int order;
  Eigen::Index fit = 0;     // samples that an end's cubic is fitted to
  Eigen::Index beyond = 0;  // samples by which it continues the end
  Eigen::Index mirror = 0;  // samples by which a point reflection continues that
};

/// Refuses a cut-off [Hz] that no filter has, or for a method that has none; 0: chosen from the data.
/// @throws EvaluationError
void checkCutoff(AccelerationMethod method, double cutoff);

/// Findings about the samples of a recording and their consequences, one sentence each.
///
/// @param clock    whose stamps they have: `header` or `receive`.
/// @param samples  what was found.
/// @param filter   what the low-pass did; nullptr where there was none.
std::vector<std::string> sampleFindings(const std::string& clock, const SampleReport& samples,
                                        const FilterChoice* filter);

/// Fills accelerations, instants and flags of a table.
///
/// @return without what has a number for each sample. @throws EvaluationError: as
///         lowPassAccelerations() does; a cut-off for a method that has none; kGiven where none are
///         recorded.
AccelerationReport findAccelerations(SampleTable& table, AccelerationMethod method,
                                     LowPassOptions options = {});

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
