// SPDX-License-Identifier: Apache-2.0

/// @file
/// Where efforts jump while a controller takes over: rule 4 of samples.hpp.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Everything up to the last jump in the first `window` [s].
///
/// @param effort  n x N; none (0 x 0): no transient is found.
/// @param sample  the fresh ones, increasing.
/// @param time    N; s.
/// @param period  s; mean distance of the samples.
Mask startTransient(const Eigen::Ref<const Eigen::MatrixXd>& effort,
                    const std::vector<Eigen::Index>& sample, const Eigen::VectorXd& time,
                    double period, double window);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
