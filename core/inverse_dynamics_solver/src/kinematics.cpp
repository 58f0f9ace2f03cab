// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/kinematics.hpp"

#include <chain_dynamics/spatial.hpp>

#include "method_call.hpp"
#include "one_state.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

Kinematics::~Kinematics() = default;

void Kinematics::getTipPose(const ConstVectorRef& q,
                            chain_dynamics::Transform<double>& pose) const {
  MethodCall("getTipPose", torqueSolver()).vector("q", q);
  computeTipPose(q, pose);
}

void Kinematics::getTipJacobian(const ConstVectorRef& q, MatrixRef J) const {
  MethodCall("getTipJacobian", torqueSolver()).vector("q", q).matrix("J", J, 6, q.size());
  computeTipJacobian(q, J);
}

void Kinematics::getTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                          MatrixRef dJ) const {
  MethodCall("getTipJacobianDerivative", torqueSolver())
      .vector("q", q)
      .vector("qd", qd)
      .matrix("dJ", dJ, 6, q.size());
  computeTipJacobianDerivative(q, qd, dJ);
}

void Kinematics::getTipPoseBatch(const ConstStatesRef& q, const StridedMatrices& R,
                                 const States& p) const {
  const BatchCall call("getTipPoseBatch", torqueSolver(), q.count);
  call.states("q", q).matrices("R", R, 3, 3).rows("p", p, 3);
  call.share([this](const auto&... part) { computeTipPoseBatch(part...); }, q, R, p);
}

void Kinematics::getTipJacobianBatch(const ConstStatesRef& q, const StridedMatrices& J) const {
  const BatchCall call("getTipJacobianBatch", torqueSolver(), q.count);
  call.states("q", q).matrices("J", J, 6, q.joints);
  call.share([this](const auto&... part) { computeTipJacobianBatch(part...); }, q,
             J.withColumns(q.joints));
}

void Kinematics::getTipJacobianDerivativeBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                               const StridedMatrices& dJ) const {
  const BatchCall call("getTipJacobianDerivativeBatch", torqueSolver(), q.count);
  call.states("q", q).states("qd", qd).matrices("dJ", dJ, 6, q.joints);
  call.share([this](const auto&... part) { computeTipJacobianDerivativeBatch(part...); }, q, qd,
             dJ.withColumns(q.joints));
}

void Kinematics::computeTipPoseBatch(const ConstStates& q, const StridedMatrices& R,
                                     const States& p) const {
  const auto pose_of_state = [this](const ConstVectorRef& q_k, MatrixRef R_k, VectorRef p_k) {
    chain_dynamics::Transform<double> pose;
    computeTipPose(q_k, pose);
    R_k = pose.R;
    p_k = pose.p;
  };
  eachState(pose_of_state, q, R, p);
}

void Kinematics::computeTipJacobianBatch(const ConstStates& q, const StridedMatrices& J) const {
  eachState([this](const auto&... of_state) { computeTipJacobian(of_state...); }, q, J);
}

void Kinematics::computeTipJacobianDerivativeBatch(const ConstStates& q, const ConstStates& qd,
                                                   const StridedMatrices& dJ) const {
  eachState([this](const auto&... of_state) { computeTipJacobianDerivative(of_state...); }, q, qd,
            dJ);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
