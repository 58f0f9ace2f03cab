// SPDX-License-Identifier: Apache-2.0

/// @file
/// Errors of computed against measured torques, joint by joint.
///
///     std::vector<JointMetrics> all = metrics(computed, measured);
///     std::vector<JointMetrics> kept = metrics(computed, measured, table.kept);
///     std::cout << all[0].rmse << " N m, " << 100 * all[0].nrmse << " %\n";
///
/// The formulas are those of docs/notation.md. Sums are compensated, so long recordings lose no
/// digits. Show metrics over a selection beside those over all samples, never instead of them.

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using chain_dynamics::OwnedMatrix;
using chain_dynamics::OwnedVector;

/// One truth value per sample.
using Mask = chain_dynamics::Owned<Eigen::Array<bool, Eigen::Dynamic, 1>>;

/// Errors of one joint's computed torques over `count` samples.
///
/// With the error `e = computed - measured`; in N m (prismatic N) but for nrmse and r2.
struct JointMetrics {
  Eigen::Index count = 0;     ///< valid samples
  double mae = 0;             ///< mean absolute error: mean of |e|
  double rmse = 0;            ///< root of the mean of e^2
  double nrmse = 0;           ///< rmse / (max - min of measured): 0.01 is 1 %
  double bias = 0;            ///< mean of e: positive where too much is computed
  double r2 = 0;              ///< 1 - sum of e^2 / sum of (measured - mean of measured)^2
  double max_abs = 0;         ///< greatest |e|
  Eigen::Index max_at = 0;    ///< sample where that is, counted over all samples
  double measured_range = 0;  ///< max - min of measured: what nrmse divides by
};

/// Errors of every joint, over all samples.
///
/// @param computed,measured  n x N, one sample per column; N m (prismatic N).
/// @return n, in the order of the rows. nrmse and r2 are NaN where the measured torque is the same
///         in all samples: there is no range to compare with.
/// @throws EvaluationError: sizes differ, no sample, a number that isn't finite (joint and sample
///         are named).
std::vector<JointMetrics> metrics(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                                  const Eigen::Ref<const Eigen::MatrixXd>& measured);

/// The same over the samples where `mask` is true.
///
/// @param mask  N; at least one sample must count. Other samples may be anything, NaN too.
std::vector<JointMetrics> metrics(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                                  const Eigen::Ref<const Eigen::MatrixXd>& measured,
                                  const Mask& mask);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
