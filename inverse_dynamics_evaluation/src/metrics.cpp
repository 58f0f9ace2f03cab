// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/metrics.hpp"

#include <cmath>
#include <limits>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

// One joint over the selected samples: a row of each.
JointMetrics rowMetrics(const Eigen::RowVectorXd& computed, const Eigen::RowVectorXd& measured,
                        const std::vector<Eigen::Index>& selected) {
  const Eigen::ArrayXd error = (computed - measured).transpose().array();
  const auto count = static_cast<double>(selected.size());
  const double mean_measured = measured.mean();
  // variance from differences to the mean: a sum of squares would lose the digits of a large mean
  const double variance = (measured.array() - mean_measured).square().sum() / count;

  JointMetrics result;
  result.count = error.size();
  result.mae = error.abs().mean();
  result.rmse = std::sqrt(error.square().mean());
  result.bias = error.mean();
  Eigen::Index at = 0;
  result.max_abs = error.abs().maxCoeff(&at);
  result.max_at = selected[static_cast<std::size_t>(at)];

  // a constant signal has no range: its mean may still be off by rounding, so ask the range
  result.measured_range = measured.maxCoeff() - measured.minCoeff();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const bool constant = result.measured_range == 0;
  result.nrmse = constant ? nan : result.rmse / result.measured_range;
  result.r2 = constant ? nan : 1.0 - error.square().mean() / variance;
  return result;
}

[[noreturn]] void throwNotFinite(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                                 const Eigen::Ref<const Eigen::MatrixXd>& measured, Eigen::Index j,
                                 Eigen::Index k) {
  const bool in_computed = !std::isfinite(computed(j, k));
  throw EvaluationError("metrics", in_computed ? "computed" : "measured", "finite numbers",
                        std::to_string(in_computed ? computed(j, k) : measured(j, k)) +
                            " for joint " + std::to_string(j) + " in sample " + std::to_string(k) +
                            " (counted from 0)",
                        "leave such samples out by a mask");
}

}  // namespace

std::vector<JointMetrics> metrics(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                                  const Eigen::Ref<const Eigen::MatrixXd>& measured,
                                  const Mask& mask) {
  requireSameSize("metrics", "computed", computed, "measured", measured);
  if (mask.size() != measured.cols()) {
    throw EvaluationError("metrics", "mask",
                          std::to_string(measured.cols()) + " truth values, one per sample",
                          std::to_string(mask.size()), "take the mask of the same recording");
  }
  if (!mask.any()) {
    throw EvaluationError("metrics", "samples", "one or more to compare",
                          "none of " + std::to_string(mask.size()), "select some");
  }

  // the selected columns, and where they were
  std::vector<Eigen::Index> selected;
  selected.reserve(static_cast<std::size_t>(mask.count()));
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) {
      selected.push_back(k);
    }
  }
  std::vector<JointMetrics> result;
  for (Eigen::Index j = 0; j < measured.rows(); ++j) {
    Eigen::RowVectorXd computed_row(static_cast<Eigen::Index>(selected.size()));
    Eigen::RowVectorXd measured_row(computed_row.size());
    for (std::size_t i = 0; i < selected.size(); ++i) {
      const Eigen::Index k = selected[i];
      if (!std::isfinite(computed(j, k)) || !std::isfinite(measured(j, k))) {
        throwNotFinite(computed, measured, j, k);
      }
      computed_row[static_cast<Eigen::Index>(i)] = computed(j, k);
      measured_row[static_cast<Eigen::Index>(i)] = measured(j, k);
    }
    result.push_back(rowMetrics(computed_row, measured_row, selected));
  }
  return result;
}

std::vector<JointMetrics> metrics(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                                  const Eigen::Ref<const Eigen::MatrixXd>& measured) {
  return metrics(computed, measured, Mask::Constant(measured.cols(), true));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
