// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/external_torque_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

const char* text(EstimateStatus status) noexcept {
  switch (status) {
    case EstimateStatus::kOk:
      return "an estimate";
    case EstimateStatus::kStarting:
      return "the velocity isn't known well enough yet: no estimate";
    case EstimateStatus::kGap:
      return "no time, a negative one or too long a time has passed: begins again";
    case EstimateStatus::kStateNotFinite:
      return "the measured state isn't finite: begins again";
    case EstimateStatus::kEffortNotFinite:
      return "a measured effort isn't finite: begins again";
    case EstimateStatus::kModelNotFinite:
      return "a torque of the model isn't finite: begins again";
    case EstimateStatus::kSolverFailed:
      return "the solver failed: begins again";
    case EstimateStatus::kWrongSize:
      return "an argument hasn't one number per joint: begins again";
  }
  return "unknown status";
}

ExternalTorqueEstimator::ExternalTorqueEstimator(
    std::shared_ptr<const InverseDynamicsSolver> solver, const EstimatorOptions& options,
    const std::string& name)
    : model_(std::move(solver), options.compensated, name),
      gain_(options.gain),
      band_(options.friction_band),
      velocity_(options.velocity),
      longest_period_(options.longest_period),
      tracker_(model_.jointCount(), options.tracking, model_.jointTypes()) {
  requireJointNumbers(name + ": gain", gain_, Range::kRate, "1/s", model_.jointNames());
  requireNumber(name + ": longest_period", longest_period_, Range::kPositive, "s");
  if (velocity_ == VelocitySource::kPositions) {
    requireNumber(name + ": tracking", options.tracking, Range::kRate, "rad/s");
    for (double& gain : gain_) gain = tracker_.lowPassBehind(gain);
    settling_time_ = tracker_.settlingTime();
    settling_updates_ = MotionTracker::kSettlingUpdates;
  }
  const Eigen::Index n = model_.jointCount();
  if (band_.size() == 0) band_.setZero(n);
  requireJointNumbers(name + ": friction_band", band_, Range::kNotNegative, "N m",
                      model_.jointNames());
  for (OwnedVector* vector :
       {&share_, &q0_, &qd0_, &q_, &qd_, &bias_, &inertial_, &left_, &filtered_, &torques_}) {
    vector->setZero(n);
  }
}

ExternalTorqueEstimator::~ExternalTorqueEstimator() = default;

void ExternalTorqueEstimator::reset() noexcept {
  running_ = false;
  filtered_.setZero();
  torques_.setZero();
}

EstimateStatus ExternalTorqueEstimator::update(const JointState& state,
                                               const ConstVectorRef& effort,
                                               double period) noexcept {
  const EstimateStatus checked = check(state, effort);
  if (checked != EstimateStatus::kOk) return refuse(checked);
  try {
    if (!running_) return beginAt(state, EstimateStatus::kStarting);
    if (period > 0 && period <= longest_period_) return advance(state, effort, period);
    return beginAt(state, EstimateStatus::kGap);
  } catch (...) {
    return refuse(EstimateStatus::kSolverFailed);
  }
}

EstimateStatus ExternalTorqueEstimator::check(const JointState& state,
                                              const ConstVectorRef& effort) const noexcept {
  const Eigen::Index n = jointCount();
  const bool measured = velocity_ == VelocitySource::kMeasured;
  if (state.q.size() != n || effort.size() != n || (measured && state.qd.size() != n)) {
    return EstimateStatus::kWrongSize;
  }
  if (!state.q.allFinite() || (measured && !state.qd.allFinite())) {
    return EstimateStatus::kStateNotFinite;
  }
  return effort.allFinite() ? EstimateStatus::kOk : EstimateStatus::kEffortNotFinite;
}

EstimateStatus ExternalTorqueEstimator::refuse(EstimateStatus why) noexcept {
  reset();
  return why;
}

EstimateStatus ExternalTorqueEstimator::beginAt(const JointState& state, EstimateStatus status) {
  reset();
  tracker_.start(state.q);
  q_ = state.q;
  if (velocity_ == VelocitySource::kMeasured) qd_ = state.qd;
  if (velocity_ == VelocitySource::kPositions) qd_.setZero();
  model_.forgetFriction();
  begin(q_, qd_);
  time_ = 0.0;
  updates_ = 0;
  running_ = true;
  return status;
}

EstimateStatus ExternalTorqueEstimator::advance(const JointState& state,
                                                const ConstVectorRef& effort, double period) {
  std::swap(q0_, q_);
  std::swap(qd0_, qd_);
  track(state, period);
  meanTorques(q0_, qd0_, q_, qd_, period, bias_, inertial_);
  if (!bias_.allFinite() || !inertial_.allFinite()) return refuse(EstimateStatus::kModelNotFinite);
  // What is left of the efforts accelerates the arm. Friction is taken off before the filter: it may
  // jump with the velocity, and a jump that is filtered beside one that isn't is a torque.
  left_ = effort - bias_;
  if (velocity_ == VelocitySource::kPositions) left_ = tracker_.filter(left_, period);
  left_ -= inertial_;
  time_ += period;
  ++updates_;
  if (time_ < settling_time_ || updates_ < settling_updates_) return EstimateStatus::kStarting;
  filter(period);
  if (!filtered_.allFinite()) return refuse(EstimateStatus::kModelNotFinite);
  return EstimateStatus::kOk;
}

void ExternalTorqueEstimator::track(const JointState& state, double period) noexcept {
  if (velocity_ == VelocitySource::kMeasured) {
    q_ = state.q;
    model_.unwrap(q0_, q_);
    qd_ = state.qd;
    return;
  }
  tracker_.update(state.q, period);
  q_ = tracker_.q();
  qd_ = tracker_.qd();
}

void ExternalTorqueEstimator::filter(double period) noexcept {
  if (period != period_) {
    for (Eigen::Index j = 0; j < share_.size(); ++j) share_[j] = -std::expm1(-gain_[j] * period);
    period_ = period;
  }
  for (Eigen::Index j = 0; j < share_.size(); ++j) {
    // r' = gain (tau - model - r), with the mean of tau - model over the period
    filtered_[j] += share_[j] * (left_[j] - filtered_[j]);
    torques_[j] = filtered_[j] - std::clamp(filtered_[j], -band_[j], band_[j]);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_control
