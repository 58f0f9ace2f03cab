// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/metrics.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

// Sums over samples, whose rounding errors are kept: of 256 samples at once, short enough to be exact
// to some roundings, then of these [Neumaier 1974, doi 10.1002/zamm.19740540106].
class Sums {
 public:
  Sums(Index joints, Index quantities)
      : part_(ArrayXXd::Zero(joints, quantities)), sum_(part_), lost_(part_) {}

  /// The next sample.
  void add(const Eigen::Ref<const ArrayXXd>& numbers) {
    part_ += numbers;
    if (++added_ % 256 == 0) join();
  }

  /// joints x quantities
  ArrayXXd total() const {
    Sums all = *this;
    all.join();
    return all.sum_ + all.lost_;
  }

 private:
  void join() {
    const ArrayXXd total = sum_ + part_;
    lost_ += (sum_.abs() >= part_.abs()).select((sum_ - total) + part_, (part_ - total) + sum_);
    sum_ = total;
    part_.setZero();
  }

  ArrayXXd part_, sum_, lost_;
  Index added_ = 0;
};

[[noreturn]] void throwNotFinite(double computed, double measured, Index j, Index k) {
  const bool in_computed = !std::isfinite(computed);
  throw EvaluationError("metrics", in_computed ? "computed" : "measured", "finite numbers",
                        std::to_string(in_computed ? computed : measured) + " for joint " +
                            std::to_string(j + 1) + " in sample " + std::to_string(k + 1) +
                            " (both counted from 1)",
                        "leave such samples out by a mask");
}

// Mean of the measured torques that count, and refuses what isn't finite.
ArrayXd meanOf(const ConstMatrix& computed, const ConstMatrix& measured, const Mask& mask) {
  Sums sums(measured.rows(), 1);
  for (Index k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    for (Index j = 0; j < measured.rows(); ++j) {
      if (!std::isfinite(computed(j, k)) || !std::isfinite(measured(j, k))) {
        throwNotFinite(computed(j, k), measured(j, k), j, k);
      }
    }
    sums.add(measured.col(k).array());
  }
  return sums.total() / static_cast<double>(mask.count());
}

// What sums of |e|, e, e^2, and squared differences of measured torques to their mean, say.
void finish(JointMetrics& joint, const Eigen::Array4d& sums) {
  const auto count = static_cast<double>(joint.count);
  joint.mae = sums[0] / count;
  joint.bias = sums[1] / count;
  joint.rmse = std::sqrt(sums[2] / count);
  // a constant signal has no range: its mean may still be off by rounding, so ask the range
  const bool constant = joint.measured_range == 0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  joint.nrmse = constant ? nan : joint.rmse / joint.measured_range;
  joint.r2 = constant ? nan : 1.0 - sums[2] / sums[3];
}

std::vector<JointMetrics> errorsOf(const ConstMatrix& computed, const ConstMatrix& measured,
                                   const Mask& mask) {
  const ArrayXd mean = meanOf(computed, measured, mask);
  const Index joints = measured.rows();
  std::vector<JointMetrics> result(static_cast<std::size_t>(joints));
  ArrayXXd terms(joints, 4);
  Sums sums(joints, 4);
  ArrayXd least = ArrayXd::Constant(joints, std::numeric_limits<double>::infinity());
  ArrayXd greatest = -least;
  for (Index k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    const auto torque = measured.col(k).array();
    terms.col(1) = computed.col(k).array() - torque;
    terms.col(0) = terms.col(1).abs();
    terms.col(2) = terms.col(1).square();
    terms.col(3) = (torque - mean).square();
    sums.add(terms);
    least = least.min(torque);
    greatest = greatest.max(torque);
    for (Index j = 0; j < joints; ++j) {
      JointMetrics& joint = result[static_cast<std::size_t>(j)];
      if (joint.count++ > 0 && terms(j, 0) <= joint.max_abs) continue;
      joint.max_abs = terms(j, 0);
      joint.max_at = k;
    }
  }
  const ArrayXXd totals = sums.total();
  for (Index j = 0; j < joints; ++j) {
    JointMetrics& joint = result[static_cast<std::size_t>(j)];
    joint.measured_range = greatest[j] - least[j];
    finish(joint, totals.row(j).transpose());
  }
  return result;
}

}  // namespace

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured,
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
  return errorsOf(computed, measured, mask);
}

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured) {
  return metrics(computed, measured, Mask::Constant(measured.cols(), true));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
