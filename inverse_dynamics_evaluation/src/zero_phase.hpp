// SPDX-License-Identifier: Apache-2.0

/// @file
/// The zero-phase filter of low_pass.hpp, and its derivative, in place.
///
///     const DerivativeRoom room(count, 125.0, 2.0, 2);
///     Eigen::MatrixXd columns(6, room.size());
///     columns.middleCols(room.begin(), count) = qd;
///     const auto qdd = room.differentiate(columns);   // where they lie: nothing is copied

#pragma once

#include <Eigen/Core>

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

/// Fills the first and the last `count` columns with point reflections, 2 x_0 - x_k, of the others.
void mirrorEnds(Eigen::Ref<Eigen::MatrixXd> samples, Eigen::Index count);

/// Room for samples and their continuation beyond both ends: cubics [ends.hpp], then reflections.
struct DerivativeRoom {
  /// @param samples  how many there are.
  DerivativeRoom(Eigen::Index samples, double frequency, double cutoff_frequency, int filter_order);

  /// Columns that the room has.
  Eigen::Index size() const { return count + 2 * begin(); }
  /// Number of the first sample's column.
  Eigen::Index begin() const { return mirror + beyond; }

  /// Derivatives [1/s] of the samples, zero-phase low-passed: lowPassDerivative().
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

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
