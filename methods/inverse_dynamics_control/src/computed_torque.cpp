// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/computed_torque.hpp"

#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <string>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

const char* const kComputedTorque = "computed torque";

}  // namespace

Gains Gains::of(const ConstVectorRef& natural_frequency, const ConstVectorRef& damping_ratio) {
  if (natural_frequency.size() != damping_ratio.size()) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        "Gains::of: damping_ratio", "wrong size",
        std::to_string(natural_frequency.size()) + " numbers, as many as natural frequencies",
        std::to_string(damping_ratio.size()), "give both for each joint");
  }
  return {natural_frequency.cwiseAbs2(), 2.0 * damping_ratio.cwiseProduct(natural_frequency)};
}

Gains Gains::uniform(Eigen::Index joints, double natural_frequency, double damping_ratio) {
  return of(Eigen::VectorXd::Constant(joints, natural_frequency),
            Eigen::VectorXd::Constant(joints, damping_ratio));
}

ComputedTorque::ComputedTorque(std::shared_ptr<const InverseDynamicsSolver> solver, Gains gains,
                               const LawOptions& options)
    : ControlLaw(std::move(solver), options, kComputedTorque), gains_(std::move(gains)) {
  const std::string law = kComputedTorque;
  if (!model().inertiaIsPhysical()) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        law + ": solver", "its inertia matrix isn't physical",
        "a symmetric, positive definite H(q), as errors are fed back through it",
        "inertiaIsPhysical() is false",
        "use the law FeedForward, or a solver made from the robot's URDF");
  }
  requireJointNumbers(law + ": Kp", gains_.Kp, Range::kNotNegative, "1/s^2", model().jointNames());
  requireJointNumbers(law + ": Kd", gains_.Kd, Range::kNotNegative, "1/s", model().jointNames());
  acceleration_ = Eigen::VectorXd::Zero(jointCount());
}

bool ComputedTorque::setGains(const Gains& gains) noexcept { return replaceGains(gains, gains_); }

Status ComputedTorque::update(const JointState& state, const Reference& reference, double period,
                              VectorRef tau) noexcept {
  for (const Status status :
       {check(state, tau), check(reference.q), check(reference.qd), check(reference.qdd)}) {
    if (status != Status::kOk) return refuse(status, state, period, tau);
  }
  return output(state, period, tau, [&](VectorRef desired) {
    // a = qdd_ref + Kp e + Kd ed,  tau = H a + C qd + g + f + d (qd_ref - qd)
    acceleration_ = reference.qdd + gains_.Kp.cwiseProduct(positionError(reference.q, state.q)) +
                    gains_.Kd.cwiseProduct(reference.qd - state.qd);
    model().torques(state.q, state.qd, acceleration_, desired);
    addFriction(state.q, state, reference, desired);
    addLostDamping(state.qd, reference.qd, desired);
  });
}

}  // namespace v2
}  // namespace inverse_dynamics_control
