// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/torque_derivatives.hpp"

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

TorqueDerivatives::~TorqueDerivatives() = default;

void TorqueDerivatives::getTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                             const ConstVectorRef& qdd, MatrixRef dtau_dq,
                                             MatrixRef dtau_dqd, MatrixRef dtau_dqdd) const {
  const Eigen::Index n = q.size();
  MethodCall("getTorqueDerivatives", torqueSolver())
      .vector("q", q)
      .vector("qd", qd)
      .vector("qdd", qdd)
      .matrix("dtau_dq", dtau_dq, n, n)
      .matrix("dtau_dqd", dtau_dqd, n, n)
      .matrix("dtau_dqdd", dtau_dqdd, n, n);
  computeTorqueDerivatives(q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
}

void TorqueDerivatives::getTorqueDerivativesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                                  const ConstStatesRef& qdd,
                                                  const StridedMatrices& dtau_dq,
                                                  const StridedMatrices& dtau_dqd,
                                                  const StridedMatrices& dtau_dqdd) const {
  const BatchCall call("getTorqueDerivativesBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).states("qdd", qdd);
  call.matrices("dtau_dq", dtau_dq, q.joints, q.joints)
      .matrices("dtau_dqd", dtau_dqd, q.joints, q.joints)
      .matrices("dtau_dqdd", dtau_dqdd, q.joints, q.joints);
  call.share([this](const auto&... part) { computeTorqueDerivativesBatch(part...); }, q, qd, qdd,
             dtau_dq, dtau_dqd, dtau_dqdd);
}

void TorqueDerivatives::computeTorqueDerivativesBatch(const ConstStates& q, const ConstStates& qd,
                                                      const ConstStates& qdd,
                                                      const StridedMatrices& dtau_dq,
                                                      const StridedMatrices& dtau_dqd,
                                                      const StridedMatrices& dtau_dqdd) const {
  eachState([this](const auto&... of_state) { computeTorqueDerivatives(of_state...); }, q, qd, qdd,
            dtau_dq, dtau_dqd, dtau_dqdd);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
