// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/pd_gravity_compensation.hpp"

#include <memory>
#include <string>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

const char* const kPdLaw = "PD with gravity compensation";

}  // namespace

PdGravityCompensation::PdGravityCompensation(std::shared_ptr<const InverseDynamicsSolver> solver,
                                             PdGains gains, const LawOptions& options)
    : ControlLaw(std::move(solver), options, kPdLaw), gains_(std::move(gains)) {
  const std::string law = kPdLaw;
  const auto joints = model().jointNames();
  requireJointNumbers(law + ": Kp", gains_.Kp, Range::kNotNegative, "N m/rad", joints);
  requireJointNumbers(law + ": Kd", gains_.Kd, Range::kNotNegative, "N m s/rad", joints);
}

bool PdGravityCompensation::setGains(const PdGains& gains) noexcept {
  return replaceGains(gains, gains_);
}

Status PdGravityCompensation::update(const JointState& state, const Reference& reference,
                                     double period, VectorRef tau) noexcept {
  for (const Status status : {check(state, tau), check(reference.q), check(reference.qd)}) {
    if (status != Status::kOk) return refuse(status, state, period, tau);
  }
  return output(state, period, tau, [&](VectorRef desired) {
    model().gravity(state.q, desired);
    desired += gains_.Kp.cwiseProduct(positionError(reference.q, state.q)) +
               gains_.Kd.cwiseProduct(reference.qd - state.qd);
    addFriction(state.q, state, reference, desired);
  });
}

}  // namespace v2
}  // namespace inverse_dynamics_control
