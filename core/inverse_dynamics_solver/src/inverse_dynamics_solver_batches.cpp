// SPDX-License-Identifier: Apache-2.0

// Batches of InverseDynamicsSolver: checks, threads, and what they compute where a solver has
// nothing better.

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

using Eigen::Index;

void InverseDynamicsSolver::getInertiaMatrixBatch(const ConstStatesRef& q,
                                                  const StridedMatrices& H) const {
  const BatchCall call("getInertiaMatrixBatch", *this, q.count);
  call.states("q", q).matrices("H", H, q.joints, q.joints);
  call.share([this](const auto&... part) { computeInertiaMatrixBatch(part...); }, q, H);
}

void InverseDynamicsSolver::getCoriolisVectorBatch(const ConstStatesRef& q,
                                                   const ConstStatesRef& qd,
                                                   const States& c) const {
  const BatchCall call("getCoriolisVectorBatch", *this, q.count);
  call.states("q", q).states("qd", qd).states("c", c);
  call.share([this](const auto&... part) { computeCoriolisVectorBatch(part...); }, q, qd, c);
}

void InverseDynamicsSolver::getFrictionVectorBatch(const ConstStatesRef& q,
                                                   const ConstStatesRef& qd,
                                                   const States& f) const {
  const BatchCall call("getFrictionVectorBatch", *this, qd.count);
  if (q.joints > 0 || q.count != qd.count) call.states("q", q);
  call.states("qd", qd).states("f", f);
  call.positionsOfFriction(q.joints);
  call.share([this](const auto&... part) { computeFrictionBatch(part...); }, q, qd, f);
}

void InverseDynamicsSolver::getGravityVectorBatch(const ConstStatesRef& q, const States& g) const {
  const BatchCall call("getGravityVectorBatch", *this, q.count);
  call.states("q", q).states("g", g);
  call.share([this](const auto&... part) { computeGravityVectorBatch(part...); }, q, g);
}

void InverseDynamicsSolver::getDynamicComponentsBatch(const ConstStatesRef& q,
                                                      const ConstStatesRef& qd,
                                                      const StridedMatrices& H, const States& c,
                                                      const States& g) const {
  const BatchCall call("getDynamicComponentsBatch", *this, q.count);
  call.states("q", q).states("qd", qd).matrices("H", H, q.joints, q.joints);
  call.states("c", c).states("g", g);
  call.share([this](const auto&... part) { computeDynamicComponentsBatch(part...); }, q, qd, H, c,
             g);
}

void InverseDynamicsSolver::getTorquesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                            const ConstStatesRef& qdd, const States& tau) const {
  const BatchCall call("getTorquesBatch", *this, q.count);
  call.states("q", q).states("qd", qd).states("qdd", qdd).states("tau", tau);
  call.share([this](const auto&... part) { computeTorquesBatch(part...); }, q, qd, qdd, tau);
}

// ---------------------------------------------------------------- defaults

void InverseDynamicsSolver::computeInertiaMatrixBatch(const ConstStates& q,
                                                      const StridedMatrices& H) const {
  eachState([this](const auto&... of_state) { computeInertiaMatrix(of_state...); }, q, H);
}

void InverseDynamicsSolver::computeCoriolisVectorBatch(const ConstStates& q, const ConstStates& qd,
                                                       const States& c) const {
  eachState([this](const auto&... of_state) { computeCoriolisVector(of_state...); }, q, qd, c);
}

void InverseDynamicsSolver::computeFrictionBatch(const ConstStates& q, const ConstStates& qd,
                                                 const States& f) const {
  eachState([this](const auto&... of_state) { computeFriction(of_state...); }, q, qd, f);
}

void InverseDynamicsSolver::computeGravityVectorBatch(const ConstStates& q, const States& g) const {
  eachState([this](const auto&... of_state) { computeGravityVector(of_state...); }, q, g);
}

void InverseDynamicsSolver::computeDynamicComponentsBatch(const ConstStates& q,
                                                          const ConstStates& qd,
                                                          const StridedMatrices& H, const States& c,
                                                          const States& g) const {
  eachState([this](const auto&... of_state) { computeDynamicComponents(of_state...); }, q, qd, H, c,
            g);
}

void InverseDynamicsSolver::computeTorquesBatch(const ConstStates& q, const ConstStates& qd,
                                                const ConstStates& qdd, const States& tau) const {
  eachState([this](const auto&... of_state) { computeTorques(of_state...); }, q, qd, qdd, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
