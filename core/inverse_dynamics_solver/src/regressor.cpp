// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/regressor.hpp"

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

Regressor::~Regressor() = default;

void Regressor::getRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                             const ConstVectorRef& qdd, MatrixRef Y) const {
  const MethodCall call("getRegressor", torqueSolver());
  call.vector("q", q).vector("qd", qd).vector("qdd", qdd);
  call.matrix("Y", Y, q.size(), 10 * linkCountImpl());
  computeRegressor(q, qd, qdd, Y);
}

void Regressor::getRegressorBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                  const ConstStatesRef& qdd, const StridedMatrices& Y) const {
  const BatchCall call("getRegressorBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).states("qdd", qdd);
  const Eigen::Index columns = 10 * linkCountImpl();
  call.matrices("Y", Y, q.joints, columns);
  call.share([this](const auto&... part) { computeRegressorBatch(part...); }, q, qd, qdd,
             Y.withColumns(columns));
}

void Regressor::computeRegressorBatch(const ConstStates& q, const ConstStates& qd,
                                      const ConstStates& qdd, const StridedMatrices& Y) const {
  eachState([this](const auto&... of_state) { computeRegressor(of_state...); }, q, qd, qdd, Y);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
