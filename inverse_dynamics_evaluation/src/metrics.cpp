// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

// Samples whose sums are taken at once: short enough to be exact to some roundings.
constexpr Index kBlock = 256;

[[noreturn]] void throwNotFinite(double computed, double measured, Index j, Index k) {
  const bool in_computed = !std::isfinite(computed);
  throw EvaluationError("metrics", in_computed ? "computed" : "measured", "finite numbers",
                        std::to_string(in_computed ? computed : measured) + " for joint " +
                            std::to_string(j + 1) + " in sample " + std::to_string(k + 1) +
                            " (both counted from 1)",
                        "leave such samples out by a mask");
}

}  // namespace

void ErrorSums::Sum::operator+=(double number) {
  const double total = sum + number;
  lost += std::abs(sum) >= std::abs(number) ? (sum - total) + number : (number - total) + sum;
  sum = total;
}

void ErrorSums::Joint::merge(const Joint& later) {
  if (later.count == 0) {
    return;
  }
  if (count == 0) {
    *this = later;
    return;
  }
  for (const auto member : {&Joint::error, &Joint::absolute, &Joint::square}) {
    (this->*member) += (later.*member).sum;
    (this->*member) += (later.*member).lost;
  }
  // [Chan, Golub, LeVeque 1983, doi 10.1080/00031305.1983.10483115]
  const auto before = static_cast<double>(count);
  const auto after = static_cast<double>(later.count);
  const double step = later.mean - mean;
  deviation += later.deviation + step * step * before * after / (before + after);
  mean += step * after / (before + after);
  least = std::min(least, later.least);
  greatest = std::max(greatest, later.greatest);
  if (later.max_abs > max_abs) {
    max_abs = later.max_abs;
    max_at = later.max_at;
  }
  count += later.count;
}

// One block of one joint.
void ErrorSums::addJoint(const ConstMatrix& computed, const ConstMatrix& measured, Index first,
                         const Mask* mask, Index j) {
  Joint block;
  double origin = 0;  // about which the variance is taken: near the mean
  double sum = 0;
  double squares = 0;
  double error_sum = 0;
  double absolute_sum = 0;
  double square_sum = 0;
  for (Index k = 0; k < measured.cols(); ++k) {
    if (mask != nullptr && !(*mask)[k]) {
      continue;
    }
    const double m = measured(j, k);
    const double e = computed(j, k) - m;
    if (!std::isfinite(computed(j, k)) || !std::isfinite(m)) {
      throwNotFinite(computed(j, k), m, j, first + k);
    }
    if (block.count == 0) {
      origin = block.least = block.greatest = m;
    }
    sum += m - origin;
    squares += (m - origin) * (m - origin);
    error_sum += e;
    absolute_sum += std::abs(e);
    square_sum += e * e;
    block.least = std::min(block.least, m);
    block.greatest = std::max(block.greatest, m);
    if (std::abs(e) > block.max_abs) {
      block.max_abs = std::abs(e);
      block.max_at = first + k;
    }
    ++block.count;
  }
  if (block.count > 0) {
    const auto count = static_cast<double>(block.count);
    block.error += error_sum;
    block.absolute += absolute_sum;
    block.square += square_sum;
    block.mean = origin + sum / count;
    block.deviation = std::max(0.0, squares - sum * sum / count);
    joints_[static_cast<std::size_t>(j)].merge(block);
  }
}

void ErrorSums::add(const ConstMatrix& computed, const ConstMatrix& measured, Index first) {
  requireSameSize("metrics", "computed", computed, "measured", measured);
  for (Index begin = 0; begin < measured.cols(); begin += kBlock) {
    const Index count = std::min(kBlock, measured.cols() - begin);
    for (Index j = 0; j < measured.rows(); ++j) {
      addJoint(computed.middleCols(begin, count), measured.middleCols(begin, count), first + begin,
               nullptr, j);
    }
  }
}

void ErrorSums::add(const ConstMatrix& computed, const ConstMatrix& measured, Index first,
                    const Mask& mask) {
  requireSameSize("metrics", "computed", computed, "measured", measured);
  requireMask("metrics", mask.size(), measured);
  for (Index begin = 0; begin < measured.cols(); begin += kBlock) {
    const Index count = std::min(kBlock, measured.cols() - begin);
    const Mask part = mask.segment(begin, count);
    for (Index j = 0; j < measured.rows(); ++j) {
      addJoint(computed.middleCols(begin, count), measured.middleCols(begin, count), first + begin,
               &part, j);
    }
  }
}

void ErrorSums::merge(const ErrorSums& later) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    joints_[j].merge(later.joints_[j]);
  }
}

std::vector<JointMetrics> ErrorSums::metrics() const {
  std::vector<JointMetrics> result;
  for (const Joint& joint : joints_) {
    if (joint.count == 0) {
      throw EvaluationError("metrics", "samples", "one or more to compare", "none", "select some");
    }
    const auto count = static_cast<double>(joint.count);
    JointMetrics metrics;
    metrics.count = joint.count;
    metrics.mae = joint.absolute.value() / count;
    metrics.rmse = std::sqrt(joint.square.value() / count);
    metrics.bias = joint.error.value() / count;
    metrics.max_abs = joint.max_abs;
    metrics.max_at = joint.max_at;
    // a constant signal has no range: its mean may still be off by rounding, so ask the range
    metrics.measured_range = joint.greatest - joint.least;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const bool constant = metrics.measured_range == 0;
    metrics.nrmse = constant ? nan : metrics.rmse / metrics.measured_range;
    metrics.r2 = constant ? nan : 1.0 - joint.square.value() / joint.deviation;
    result.push_back(metrics);
  }
  return result;
}

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured,
                                  const Mask& mask) {
  ErrorSums sums(measured.rows());
  requireSameSize("metrics", "computed", computed, "measured", measured);
  requireMask("metrics", mask.size(), measured);
  if (!mask.any()) {
    throw EvaluationError("metrics", "samples", "one or more to compare",
                          "none of " + std::to_string(mask.size()), "select some");
  }
  sums.add(computed, measured, 0, mask);
  return sums.metrics();
}

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured) {
  return metrics(computed, measured, Mask::Constant(measured.cols(), true));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
