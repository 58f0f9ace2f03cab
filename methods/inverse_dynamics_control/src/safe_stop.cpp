// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/safe_stop.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

SafeStop::SafeStop(const Eigen::Ref<const Eigen::VectorXd>& deceleration,
                   const std::vector<std::string>& joint_names)
    : deceleration_(deceleration),
      q_(Eigen::VectorXd::Zero(deceleration.size())),
      qd_(Eigen::VectorXd::Zero(deceleration.size())) {
  requireJointNumbers("safe stop: deceleration", deceleration, Range::kPositive, "rad/s^2",
                      joint_names);
}

Status SafeStop::begin(const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& qd) noexcept {
  if (q.size() != q_.size() || qd.size() != q_.size()) return Status::kWrongSize;
  if (!q.allFinite() || !qd.allFinite()) return Status::kReferenceNotFinite;
  q_ = q;
  qd_ = qd;
  duration_ = qd.cwiseAbs().cwiseQuotient(deceleration_).maxCoeff();
  time_ = 0.0;
  begun_ = true;
  return Status::kOk;
}

Status SafeStop::advance(double period, Reference& reference) noexcept {
  const Eigen::Index n = q_.size();
  if (reference.q.size() != n || reference.qd.size() != n || reference.qdd.size() != n) {
    return Status::kWrongSize;
  }
  if (!begun_) return Status::kReferenceNotFinite;
  if (period > 0) time_ = std::min(time_ + period, duration_);
  if (time_ < duration_) {
    reference.q = q_ + qd_ * (time_ * (1.0 - 0.5 * time_ / duration_));
    reference.qd = qd_ * (1.0 - time_ / duration_);
    reference.qdd = qd_ / -duration_;
  } else {
    reference.q = q_ + qd_ * (0.5 * duration_);
    reference.qd.setZero();
    reference.qdd.setZero();
  }
  return Status::kOk;
}

}  // namespace v2
}  // namespace inverse_dynamics_control
