// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/feed_forward.hpp"

#include <memory>
#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {

FeedForward::FeedForward(std::shared_ptr<const InverseDynamicsSolver> solver, ModelState at,
                         const LawOptions& options)
    : ControlLaw(std::move(solver), options, "feed-forward"), at_(at) {}

Status FeedForward::update(const JointState& state, const Reference& reference,
                           const ConstVectorRef& effort, double period, VectorRef tau) noexcept {
  for (const Status status : {check(state, tau), check(reference.q), check(reference.qd),
                              check(reference.qdd), check(effort)}) {
    if (status != Status::kOk) return refuse(status, state, period, tau);
  }
  return output(state, period, tau, [&](VectorRef desired) {
    // tau = effort + H qdd_ref + C qd + g + f
    const bool measured = at_ == ModelState::kMeasured;
    const auto& q = measured ? state.q : reference.q;
    model().torques(q, measured ? state.qd : reference.qd, reference.qdd, desired);
    addFriction(q, state, reference, desired);
    desired += effort;
  });
}

}  // namespace v2
}  // namespace inverse_dynamics_control
