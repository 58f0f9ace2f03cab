// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/output_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

constexpr double kLongestPeriod = 1.0;  // s

}  // namespace

OutputStage::OutputStage(const OutputLimits& limits, const std::vector<std::string>& joint_names,
                         const std::string& law)
    : limits_(limits) {
  requireJointNumbers(law + ": limits: effort", limits.effort, Range::kPositiveOrAbsent, "N m",
                      joint_names);
  const Eigen::Index n = limits.effort.size();
  if (limits.rate.size() == 0) {
    limits_.rate = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  } else {
    requireJointNumbers(law + ": limits: rate", limits.rate, Range::kPositiveOrAbsent, "N m/s",
                        joint_names);
  }
  last_ = Eigen::VectorXd::Zero(n);
  saturated_ = rate_limited_ = Joints::Constant(n, false);
}

void OutputStage::start(const Eigen::Ref<const Eigen::VectorXd>& effort) noexcept {
  started_ = effort.size() == last_.size() && effort.allFinite();
  if (started_) last_ = effort;
}

Status OutputStage::apply(const Eigen::Ref<const Eigen::VectorXd>& desired, double period,
                          Eigen::Ref<Eigen::VectorXd> tau) noexcept {
  const bool timed = period > 0 && period <= kLongestPeriod;  // no NaN is
  for (Eigen::Index j = 0; j < last_.size(); ++j) {
    // Infinity times zero is NaN, so joints without a rate limit are left out.
    double reachable = desired[j];
    if (started_ && std::isfinite(limits_.rate[j])) {
      const double change = timed ? limits_.rate[j] * period : 0.0;
      reachable = std::clamp(desired[j], last_[j] - change, last_[j] + change);
    }
    saturated_[j] = std::abs(desired[j]) > limits_.effort[j];
    last_[j] = std::clamp(reachable, -limits_.effort[j], limits_.effort[j]);
    rate_limited_[j] = reachable != desired[j];
  }
  tau = last_;
  started_ = true;
  if (!timed) return Status::kNoPeriod;
  if (saturated_.any()) return Status::kSaturated;
  return rate_limited_.any() ? Status::kRateLimited : Status::kOk;
}

}  // namespace v2
}  // namespace inverse_dynamics_control
