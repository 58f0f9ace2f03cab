// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/forward_dynamics.hpp"

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

ForwardDynamics::~ForwardDynamics() = default;

void ForwardDynamics::getAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       const ConstVectorRef& tau, VectorRef qdd) const {
  MethodCall("getAccelerations", torqueSolver())
      .vector("q", q)
      .vector("qd", qd)
      .vector("tau", tau)
      .vector("qdd", qdd)
      .physicalInertia();
  computeAccelerations(q, qd, tau, qdd);
}

void ForwardDynamics::getAccelerationsBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                            const ConstStatesRef& tau, const States& qdd) const {
  const BatchCall call("getAccelerationsBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).states("tau", tau).states("qdd", qdd).physicalInertia();
  call.share([this](const auto&... part) { computeAccelerationsBatch(part...); }, q, qd, tau, qdd);
}

void ForwardDynamics::computeAccelerationsBatch(const ConstStates& q, const ConstStates& qd,
                                                const ConstStates& tau, const States& qdd) const {
  eachState([this](const auto&... of_state) { computeAccelerations(of_state...); }, q, qd, tau,
            qdd);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
