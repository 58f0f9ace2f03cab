// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

// Sums over samples of n joints, whose rounding errors are kept: of 256 samples at once, short enough
// to be exact to some roundings, then of these [Neumaier 1974, doi 10.1002/zamm.19740540106].
class Sums {
 public:
  explicit Sums(Index joints) : part_(ArrayXd::Zero(joints)), sum_(part_), lost_(part_) {}

  /// The next sample.
  template <class Numbers>
  void add(const Eigen::ArrayBase<Numbers>& numbers) {
    part_ += numbers;
    if (++added_ % 256 == 0) join();
  }

  ArrayXd total() const {
    Sums all = *this;
    all.join();
    return all.sum_ + all.lost_;
  }

 private:
  void join() {
    const ArrayXd total = sum_ + part_;
    lost_ += (sum_.abs() >= part_.abs()).select((sum_ - total) + part_, (part_ - total) + sum_);
    sum_ = total;
    part_.setZero();
  }

  ArrayXd part_, sum_, lost_;
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
  Sums sums(measured.rows());
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

// What metrics are made of.
class Errors {
 public:
  /// @param mean  of the measured torques.
  explicit Errors(const ArrayXd& mean)
      : mean_(mean),
        error_(mean.size()),
        sum_(mean.size()),
        absolute_(mean.size()),
        square_(mean.size()),
        deviation_(mean.size()),
        least_(ArrayXd::Constant(mean.size(), std::numeric_limits<double>::infinity())),
        greatest_(-least_),
        metrics_(static_cast<std::size_t>(mean.size())) {}

  void add(const ConstVector& computed, const ConstVector& measured, Index k) {
    error_ = computed.array() - measured.array();
    sum_.add(error_);
    absolute_.add(error_.abs());
    square_.add(error_.square());
    deviation_.add((measured.array() - mean_).square());
    least_ = least_.min(measured.array());
    greatest_ = greatest_.max(measured.array());
    for (Index j = 0; j < error_.size(); ++j) {
      JointMetrics& joint = metrics_[static_cast<std::size_t>(j)];
      if (joint.count++ == 0 || std::abs(error_[j]) > joint.max_abs) {
        joint.max_abs = std::abs(error_[j]);
        joint.max_at = k;
      }
    }
  }

  std::vector<JointMetrics> metrics() const {
    std::vector<JointMetrics> result = metrics_;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (Index j = 0; j < error_.size(); ++j) {
      JointMetrics& joint = result[static_cast<std::size_t>(j)];
      const auto count = static_cast<double>(joint.count);
      joint.mae = absolute_.total()[j] / count;
      joint.rmse = std::sqrt(square_.total()[j] / count);
      joint.bias = sum_.total()[j] / count;
      // a constant signal has no range: its mean may still be off by rounding, so ask the range
      joint.measured_range = greatest_[j] - least_[j];
      const bool constant = joint.measured_range == 0;
      joint.nrmse = constant ? nan : joint.rmse / joint.measured_range;
      joint.r2 = constant ? nan : 1.0 - square_.total()[j] / deviation_.total()[j];
    }
    return result;
  }

 private:
  ArrayXd mean_, error_;
  Sums sum_, absolute_, square_, deviation_;  // of e, |e|, e^2; squared differences to the mean
  ArrayXd least_, greatest_;                  // measured
  std::vector<JointMetrics> metrics_;
};

}  // namespace

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured,
                                  const Mask& mask) {
  requireSameSize("metrics", "computed", computed, "measured", measured);
  requireMask("metrics", mask.size(), measured);
  if (!mask.any()) {
    throw EvaluationError("metrics", "samples", "one or more to compare",
                          "none of " + std::to_string(mask.size()), "select some");
  }
  Errors errors(meanOf(computed, measured, mask));
  for (Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) errors.add(computed.col(k), measured.col(k), k);
  }
  return errors.metrics();
}

std::vector<JointMetrics> metrics(const ConstMatrix& computed, const ConstMatrix& measured) {
  return metrics(computed, measured, Mask::Constant(measured.cols(), true));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
