// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/control_law.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

ControlLaw::ControlLaw(std::shared_ptr<const InverseDynamicsSolver> solver,
                       const LawOptions& options, const std::string& law)
    : model_(std::move(solver), options.compensated, law),
      friction_(options.friction, law),
      output_(options.limits, model_.jointNames(), law),
      damping_(options.damping) {
  requireJointNumbers(law + ": damping", damping_, Range::kNotNegative, "N m s/rad",
                      model_.jointNames());
  for (OwnedVector* vector : {&desired_, &f_, &error_, &gravity_, &gravity_candidate_}) {
    *vector = Eigen::VectorXd::Zero(model_.jointCount());
  }
}

void ControlLaw::start(const ConstVectorRef& effort, const ConstVectorRef& gravity) noexcept {
  start(effort);
  if (check(gravity) == Status::kOk) gravity_ = gravity;
}

Status ControlLaw::hold(const JointState& state, double period, VectorRef tau) noexcept {
  return refuse(check(state, tau), state, period, tau);
}

const OwnedVector& ControlLaw::positionError(const ConstVectorRef& q_ref,
                                             const ConstVectorRef& q) noexcept {
  error_ = q_ref;
  model_.unwrap(q, error_);
  error_ -= q;
  return error_;
}

bool ControlLaw::setDamping(const ConstVectorRef& damping) noexcept {
  if (!areJointNumbers(damping, Range::kNotNegative, jointCount())) return false;
  damping_ = damping;
  return true;
}

Status ControlLaw::check(const JointState& state, const VectorRef& tau) const noexcept {
  const Eigen::Index n = jointCount();
  if (state.q.size() != n || state.qd.size() != n || tau.size() != n) return Status::kWrongSize;
  return state.q.allFinite() && state.qd.allFinite() ? Status::kOk : Status::kStateNotFinite;
}

Status ControlLaw::check(const ConstVectorRef& reference) const noexcept {
  if (reference.size() != jointCount()) return Status::kWrongSize;
  return reference.allFinite() ? Status::kOk : Status::kReferenceNotFinite;
}

void ControlLaw::addFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                             const ConstVectorRef& qd_reference, VectorRef tau) {
  if (friction_.source() == FrictionSource::kNone) return;
  const bool measured = friction_.source() == FrictionSource::kMeasuredVelocity;
  const ConstVectorRef& v = measured ? qd : qd_reference;
  model_.friction(q, v, f_);
  friction_.weigh(v, f_);
  tau += f_;
}

void ControlLaw::addLostDamping(const ConstVectorRef& qd, const ConstVectorRef& qd_reference,
                                VectorRef tau) const {
  if (friction_.source() != FrictionSource::kReferenceVelocity) return;
  for (Eigen::Index j = 0; j < tau.size(); ++j) tau[j] += model_.lostDamping(j, qd, qd_reference);
}

Status ControlLaw::refuse(Status why, const JointState& state, double period,
                          VectorRef tau) noexcept {
  const Eigen::Index n = jointCount();
  if (tau.size() != n) {
    tau.setZero();
    return why;
  }
  // g(q) - damping qd, of what is known
  const bool positioned = state.q.size() == n && state.q.allFinite();
  if (positioned && !updateGravity(state.q) && why == Status::kOk) why = Status::kSolverFailed;
  desired_ = gravity_;
  for (Eigen::Index j = 0; state.qd.size() == n && j < n; ++j) {
    if (std::isfinite(state.qd[j])) desired_[j] -= damping_[j] * state.qd[j];
  }
  const Status limited = output_.apply(desired_, period, tau);
  return why == Status::kOk ? limited : why;
}

bool ControlLaw::updateGravity(const ConstVectorRef& q) noexcept {
  try {
    model_.gravity(q, gravity_candidate_);
    if (!gravity_candidate_.allFinite()) return false;
    gravity_ = gravity_candidate_;
    return true;
  } catch (...) {  // a solver that fails: gravity stays what it was
    return false;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_control
