// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/motion_tracker.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

/// Response of tracker and low-pass to a unit step, in the time unit 1 / bandwidth.
///
/// Of `(3 s + 1) / (s + 1)^3  k / (s + k)  1 / s` by partial fractions; k below one.
double stepResponse(double time, double k) noexcept {
  const double d = 1.0 - k, residue = (1.0 - 3.0 * k) / (d * d * d);
  const double linear = residue * d - 1.0, quadratic = -k / d;
  return 1.0 - residue * std::exp(-k * time) +
         std::exp(-time) * (residue - 1.0 + time * (linear + time * quadratic));
}

}  // namespace

MotionTracker::MotionTracker(Eigen::Index joints, double bandwidth,
                             std::vector<chain_dynamics::JointType> types)
    : bandwidth_(bandwidth), types_(std::move(types)) {
  types_.resize(static_cast<std::size_t>(joints), chain_dynamics::JointType::kRevolute);
  for (OwnedVector* vector : {&q_, &qd_, &qdd_, &dx_, &dv_, &push_, &filtered_}) {
    vector->setZero(joints);
  }
}

double MotionTracker::lowPassBehind(double gain) const noexcept {
  const double designed = std::min(gain / bandwidth_, 0.3);
  double low = 0.5 * designed, high = 1.2 * designed;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (stepResponse(1.0 / designed, middle) < 1.0 - std::exp(-1.0) ? low : high) = middle;
  }
  return gain * (low / designed);
}

void MotionTracker::start(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept {
  for (OwnedVector* vector : {&qd_, &qdd_, &dx_, &dv_}) vector->setZero();
  q_ = q;
  moving_ = pushed_ = false;
}

void MotionTracker::update(const Eigen::Ref<const Eigen::VectorXd>& q, double period) noexcept {
  if (period != period_) chooseGains(period);
  const double T = period;
  for (Eigen::Index j = 0; j < q_.size(); ++j) {
    // predict, then correct by the position error
    const double q_predicted = q_[j] + T * (qd_[j] + 0.5 * T * qdd_[j]);
    const auto type = types_[static_cast<std::size_t>(j)];
    const double next = chain_dynamics::unwrapped(type, q[j], q_predicted);
    const double error = next - q_predicted;
    if (!moving_) {
      q_[j] = next;
      qd_[j] = error / T;
      continue;
    }
    q_[j] = q_predicted + g_ * error;
    qd_[j] += T * qdd_[j] + h_ / T * error;
    qdd_[j] += k_ / (T * T) * error;
  }
  moving_ = true;
}

const OwnedVector& MotionTracker::filter(const Eigen::Ref<const Eigen::VectorXd>& torques,
                                         double period) noexcept {
  if (period != period_) chooseGains(period);
  const double T = period;
  if (!pushed_) push_ = torques;
  pushed_ = true;
  for (Eigen::Index j = 0; j < push_.size(); ++j) {
    // the same of a unit mass, in terms of true minus tracked
    const double unknown = torques[j] - push_[j];
    const double dx_predicted = dx_[j] + T * (dv_[j] + 0.5 * T * unknown);
    const double dv = dv_[j] + T * unknown - h_ / T * dx_predicted;
    filtered_[j] = torques[j] - (dv - dv_[j]) / T;
    dx_[j] = (1.0 - g_) * dx_predicted;
    dv_[j] = dv;
    push_[j] += k_ / (T * T) * dx_predicted;
  }
  return filtered_;
}

void MotionTracker::chooseGains(double period) noexcept {
  // three poles at z
  const double z = std::exp(-bandwidth_ * period), w = 1.0 - z;
  g_ = 1.0 - z * z * z;
  h_ = 1.5 * w * w * (1.0 + z);
  k_ = w * w * w;
  period_ = period;
}

}  // namespace v2
}  // namespace inverse_dynamics_control
