// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/gravity_compensation.hpp"

#include <limits>
#include <memory>
#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {

GravityCompensation::GravityCompensation(std::shared_ptr<const InverseDynamicsSolver> solver,
                                         const LawOptions& options)
    : ControlLaw(std::move(solver), options, "gravity compensation"),
      rest_(Eigen::VectorXd::Zero(jointCount())),
      guide_(jointCount()) {
  guide_.q.setConstant(std::numeric_limits<double>::quiet_NaN());
}

Status GravityCompensation::update(const JointState& state, double period, VectorRef tau) noexcept {
  return update(state, rest_, period, tau);
}

Status GravityCompensation::update(const JointState& state, const ConstVectorRef& qd_reference,
                                   double period, VectorRef tau) noexcept {
  for (const Status status : {check(state, tau), check(qd_reference)}) {
    if (status != Status::kOk) return refuse(status, state, period, tau);
  }
  return output(state, period, tau, [&](VectorRef desired) {
    model().gravity(state.q, desired);
    damp(state.q, state.qd, desired);
    guide_.qd = qd_reference;
    addFriction(state.q, state, guide_, desired);
  });
}

}  // namespace v2
}  // namespace inverse_dynamics_control
