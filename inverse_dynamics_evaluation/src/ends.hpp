// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a velocity may have been before the first sample and after the last one.
///
///     Eigen::MatrixXd before = beyondEnd(qd.leftCols(60), 100);   // 100 samples, backwards in
///     time
///
/// A filter that runs forwards and backwards needs samples beyond both ends. The point reflection,
/// 2 x_0 - x_k, is what lowPass() takes: it keeps value and slope, but its value at the end is that
/// of one noisy sample, so the noise of that sample becomes a step of twice its size, and the
/// curvature changes its sign there. A cubic through the last samples averages their noise and goes
/// on with slope and curvature. Its fit sees one to two periods of the cut-off, so it follows what
/// the filter lets through. At the ends the acceleration is then about as good as one from samples
/// of one side can be; docs/accuracy.md has the figures.

#pragma once

#include <Eigen/Core>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Samples without which an end can't be continued, if there are as many.
constexpr Eigen::Index kLeastFit = 6;

/// Continuation of each row beyond its first sample, by the cubic that fits the samples best there.
///
/// @param samples  n x N, equidistant, N >= 4; the first one is the end, so for the end of a
///                 recording time is counted backwards. Weights fall from one at the first sample
///                 to zero behind the last (cos^2 of the amplitude).
/// @param count    samples by which the end is continued.
/// @return n x count; the nearest first.
Eigen::MatrixXd beyondEnd(const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index count);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
