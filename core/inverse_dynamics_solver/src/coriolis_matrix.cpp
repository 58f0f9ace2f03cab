// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/coriolis_matrix.hpp"

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

CoriolisMatrix::~CoriolisMatrix() = default;

void CoriolisMatrix::getCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       MatrixRef C) const {
  MethodCall("getCoriolisMatrix", torqueSolver())
      .vector("q", q)
      .vector("qd", qd)
      .matrix("C", C, q.size(), q.size());
  computeCoriolisMatrix(q, qd, C);
}

void CoriolisMatrix::getCoriolisMatrixBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                            const StridedMatrices& C) const {
  const BatchCall call("getCoriolisMatrixBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).matrices("C", C, q.joints, q.joints);
  call.share([this](const auto&... part) { computeCoriolisMatrixBatch(part...); }, q, qd, C);
}

void CoriolisMatrix::computeCoriolisMatrixBatch(const ConstStates& q, const ConstStates& qd,
                                                const StridedMatrices& C) const {
  eachState([this](const auto&... of_state) { computeCoriolisMatrix(of_state...); }, q, qd, C);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
