// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/control_law.hpp"

#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
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
      damping_(options.damping),
      damping_rate_(options.damping_rate) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model_.jointCount());
  requireNumber(law + ": damping_rate", damping_rate_, Range::kNotNegative, "1/s");
  if (damping_rate_ > 0 && !model_.inertiaIsPhysical()) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        law + ": damping_rate", "no damping", "zero, as inertiaIsPhysical() is false",
        numberText(damping_rate_),
        "take a solver made from the robot's URDF, or give the damping of each joint");
  }
  if (damping_rate_ > 0 && damping_.size() == 0) damping_ = zero;
  requireJointNumbers(law + ": damping", damping_, Range::kNotNegative, "N m s/rad",
                      model_.jointNames());
  for (OwnedVector* vector : {&desired_, &f_, &error_, &gravity_}) *vector = zero;
  q_ = Eigen::VectorXd::Constant(zero.size(), std::numeric_limits<double>::quiet_NaN());
}

void ControlLaw::start(const ConstVectorRef& effort, const ConstVectorRef& position) noexcept {
  start(effort);
  remember(position);
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

bool ControlLaw::setDamping(const ConstVectorRef& damping, double rate) noexcept {
  if (!areJointNumbers(damping, Range::kNotNegative, jointCount())) return false;
  if (!(rate >= 0) || !std::isfinite(rate) || (rate > 0 && !model_.inertiaIsPhysical()))
    return false;
  damping_ = damping;
  damping_rate_ = rate;
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

void ControlLaw::addFriction(const ConstVectorRef& q, const JointState& state,
                             const Reference& reference, VectorRef tau) {
  if (friction_.source() == FrictionSource::kNone) return;
  const bool measured = friction_.source() == FrictionSource::kMeasuredVelocity;
  const OwnedVector& v = measured ? state.qd : reference.qd;
  model_.moveFriction(measured ? state.q : reference.q);
  model_.friction(q, v, f_);
  friction_.weigh(v, f_);
  tau += f_;
  model_.rememberedFriction(f_);
  friction_.weighRest(v, f_);
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
  // g(q) - D qd, of what is known
  if (!remember(state.q) && why == Status::kOk) why = Status::kSolverFailed;
  desired_ = gravity_;
  if (state.qd.size() == n) {
    for (Eigen::Index j = 0; j < n; ++j) error_[j] = std::isfinite(state.qd[j]) ? state.qd[j] : 0.0;
    f_.setZero();
    try {
      damp(q_, error_, f_);
    } catch (...) {  // a solver that fails
      f_.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    if (!f_.allFinite()) f_ = -damping_.cwiseProduct(error_);
    desired_ += f_;
  }
  const Status limited = output_.apply(desired_, period, tau);
  return why == Status::kOk ? limited : why;
}

void ControlLaw::damp(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef tau) {
  tau -= damping_.cwiseProduct(qd);
  if (damping_rate_ > 0) tau.noalias() -= damping_rate_ * model_.inertia(q).lazyProduct(qd);
}

bool ControlLaw::remember(const ConstVectorRef& q) noexcept {
  if (q.size() != jointCount()) return true;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (std::isfinite(q[j])) q_[j] = q[j];
  }
  if (!q_.allFinite()) return true;
  try {
    model_.gravity(q_, f_);
  } catch (...) {  // gravity stays what it was
    return false;
  }
  if (!f_.allFinite()) return false;
  gravity_ = f_;
  return true;
}

}  // namespace v2
}  // namespace inverse_dynamics_control
