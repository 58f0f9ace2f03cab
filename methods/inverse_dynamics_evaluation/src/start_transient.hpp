// SPDX-License-Identifier: Apache-2.0

/// @file
/// Where efforts jump while a controller takes over: rule 4 of samples.hpp.

#pragma once

#include <Eigen/Core>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Samples, repeats aside, in which a start transient is told from the rest: longer recordings have
/// no more influence.
constexpr Eigen::Index kMostForTransient = 65536;

/// How many samples there are up to the last jump in the first `window` [s].
///
/// @param effort   n x N; none is a repeat.
/// @param instant  N; s; increasing.
/// @param period   s; mean distance of the samples.
Eigen::Index startTransient(const Eigen::Ref<const Eigen::MatrixXd>& effort,
                            const Eigen::VectorXd& instant, double period, double window);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
