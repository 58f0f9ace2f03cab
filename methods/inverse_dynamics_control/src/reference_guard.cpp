// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/reference_guard.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

// Tolerance for references at the limit; motions timed within limits pass them by up to 0.3 %
// [inverse_dynamics_timing].
constexpr double kRounding = 1e-9;
constexpr double kTimed = 1.005;             // times a limit
constexpr double kTurn = 6.283185307179586;  // rad

struct Fault {
  StopReason reason = StopReason::kNone;
  Eigen::Index joint = -1;
};

// Whether a reference changes by more than `reach`, other than towards the measured state.
bool steps(double change, double measured, double reach) noexcept {
  const double nearer = std::isfinite(measured) ? measured : 0.0;
  return change < std::min(0.0, nearer) - reach || change > std::max(0.0, nearer) + reach;
}

// The first joint that is too far from `last` for so many seconds.
Fault stepOf(const Reference& desired, const Reference& last, const JointState& measured,
             const ReferenceLimits& limits, const std::vector<chain_dynamics::JointType>& types,
             double seconds) noexcept {
  for (Eigen::Index j = 0; j < last.q.size(); ++j) {
    const auto type = types[static_cast<std::size_t>(j)];
    const auto change = [&](double q) {
      return chain_dynamics::unwrapped(type, q, last.q[j]) - last.q[j];
    };
    const double fastest = std::max(limits.acceleration[j], limits.deceleration[j]);
    if (steps(change(desired.q[j]), change(measured.q[j]),
              limits.velocity[j] * seconds + kRounding) ||
        steps(desired.qd[j] - last.qd[j], measured.qd[j] - last.qd[j],
              fastest * seconds + kRounding)) {
      return {StopReason::kStep, j};
    }
  }
  return {};
}

Fault faultOf(const Reference& desired, const ReferenceLimits& limits,
              const std::vector<chain_dynamics::JointType>& types) noexcept {
  const Eigen::Index n = limits.velocity.size();
  if (desired.q.size() != n || desired.qd.size() != n || desired.qdd.size() != n) {
    return {StopReason::kWrongSize, -1};
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    double q = desired.q[j];
    const double qd = desired.qd[j], qdd = desired.qdd[j];
    if (!std::isfinite(q) || !std::isfinite(qd) || !std::isfinite(qdd)) {
      return {StopReason::kNotFinite, j};
    }
    if (limits.upper[j] - limits.lower[j] <= kTurn) {  // wider ones count turns: of a cable
      const double middle = 0.5 * (limits.lower[j] + limits.upper[j]);
      q = chain_dynamics::unwrapped(types[static_cast<std::size_t>(j)], q, middle);
    }
    if (q < limits.lower[j] - kRounding || q > limits.upper[j] + kRounding) {
      return {StopReason::kPosition, j};
    }
    if (std::abs(qd) > kTimed * limits.velocity[j] + kRounding) return {StopReason::kVelocity, j};
    const double most = qd * qdd < 0 ? limits.deceleration[j] : limits.acceleration[j];
    if (std::abs(qdd) > kTimed * most + kRounding) return {StopReason::kAcceleration, j};
  }
  return {};
}

}  // namespace

ReferenceLimits ReferenceLimits::none(Eigen::Index joints) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd unlimited = Eigen::VectorXd::Constant(joints, kInfinity);
  return {-unlimited, unlimited, unlimited, unlimited, unlimited};
}

const char* text(StopReason reason) noexcept {
  switch (reason) {
    case StopReason::kNone:
      return "the reference is followed";
    case StopReason::kNotFinite:
      return "the reference is NaN or infinite";
    case StopReason::kPosition:
      return "the reference's position lies beyond its limits";
    case StopReason::kVelocity:
      return "the reference's velocity lies beyond its limit";
    case StopReason::kAcceleration:
      return "the reference's acceleration lies beyond its limit";
    case StopReason::kStep:
      return "the reference steps farther than the limits of velocity and acceleration allow";
    case StopReason::kStale:
      return "no new reference came while the last one still moves";
    case StopReason::kWrongSize:
      return "the reference hasn't one number per joint";
  }
  return "unknown reason";
}

ReferenceGuard::ReferenceGuard(ReferenceLimits limits,
                               const Eigen::Ref<const Eigen::VectorXd>& deceleration,
                               const std::vector<std::string>& joint_names,
                               std::vector<chain_dynamics::JointType> joint_types, Steps steps)
    : limits_(std::move(limits)),
      types_(std::move(joint_types)),
      safe_stop_(deceleration, joint_names),
      steps_(steps),
      slope_(deceleration),
      followed_(deceleration.size()),
      unknown_(deceleration.size()) {
  unknown_.q.setConstant(std::numeric_limits<double>::quiet_NaN());
  unknown_.qd = unknown_.q;
  const std::string where = "reference guard: ";
  requireJointNumbers(where + "velocity limit", limits_.velocity, Range::kPositiveOrAbsent, "rad/s",
                      joint_names);
  requireJointNumbers(where + "acceleration limit", limits_.acceleration, Range::kPositiveOrAbsent,
                      "rad/s^2", joint_names);
  requireJointNumbers(where + "deceleration limit", limits_.deceleration, Range::kPositiveOrAbsent,
                      "rad/s^2", joint_names);
  requireJointNumbers(where + "lower position limit", limits_.lower, Range::kAny, "rad",
                      joint_names);
  requireJointNumbers(where + "upper position limit", limits_.upper, Range::kAny, "rad",
                      joint_names);
  const Eigen::VectorXd width = limits_.upper - limits_.lower;
  requireJointNumbers(where + "upper minus lower position limit", width, Range::kPositiveOrAbsent,
                      "rad", joint_names);
  types_.resize(joint_names.size(), chain_dynamics::JointType::kRevolute);
}

void ReferenceGuard::start(const Eigen::Ref<const Eigen::VectorXd>& q,
                           const Eigen::Ref<const Eigen::VectorXd>& qd) noexcept {
  if (safe_stop_.begin(q, qd) == Status::kWrongSize) return stop(StopReason::kWrongSize);
  followed_.q = q;
  followed_.qd = qd;
  followed_.qdd.setZero();
  following_ = moving_ = ramping_ = false;
  reason_ = StopReason::kNone;
  joint_ = -1;
}

const Reference& ReferenceGuard::next(const Reference& desired, double period, double interval,
                                      const JointState& measured) noexcept {
  if (stopped()) return again(period);
  Fault fault = faultOf(desired, limits_, types_);
  if (fault.reason == StopReason::kNone && !ramping_) {
    const Fault step = stepOf(desired, followed_, measured, limits_, types_, interval + period);
    ramping_ = step.reason != StopReason::kNone && steps_ == Steps::kRamp;
    if (!ramping_) fault = step;
  }
  if (fault.reason != StopReason::kNone) {
    stop(fault.reason, fault.joint);
    return again(period);
  }
  following_ = true;
  moving_ = (desired.qd.array() != 0.0).any() || (desired.qdd.array() != 0.0).any();
  if (ramping_) ramping_ = !approach(desired, period);
  if (!ramping_) {
    followed_.q = desired.q;
    followed_.qd = desired.qd;
    followed_.qdd = desired.qdd;
  }
  return followed_;
}

bool ReferenceGuard::approach(const Reference& desired, double period) noexcept {
  if (!(period > 0)) return false;
  bool there = true;
  for (Eigen::Index j = 0; j < followed_.q.size(); ++j) {
    const double change = slope_[j] * period, limit = limits_.velocity[j];
    double &q = followed_.q[j], &qd = followed_.qd[j];
    const double way =
        chain_dynamics::unwrapped(types_[static_cast<std::size_t>(j)], desired.q[j], q) - q;
    there = there && std::abs(way) <= change * period && std::abs(desired.qd[j] - qd) <= change;
    // The speed from which it still stops there: v T + v^2 / (2 a) = way.
    const double speed = std::sqrt(change * change + 2.0 * slope_[j] * std::abs(way)) - change;
    const double wanted = std::clamp(desired.qd[j] + std::copysign(speed, way), -limit, limit);
    const double next = std::clamp(wanted, qd - change, qd + change);
    followed_.qdd[j] = (next - qd) / period;
    qd = next;
    q += qd * period;
  }
  return there;
}

const Reference& ReferenceGuard::again(double period) noexcept {
  if (!following_) safe_stop_.advance(period, followed_);
  return followed_;
}

void ReferenceGuard::stop(StopReason reason, Eigen::Index joint) noexcept {
  if (stopped() || reason == StopReason::kNone) return;
  reason_ = reason;
  joint_ = joint;
  following_ = false;
  safe_stop_.begin(followed_.q, followed_.qd);
}

}  // namespace v2
}  // namespace inverse_dynamics_control
