// SPDX-License-Identifier: Apache-2.0

// The tip's kinematics by Pinocchio.

#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "pinocchio_workspace.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

void PinocchioWorkspace::tipPose(std::size_t tip, const ConstVectorRef& q,
                                 chain_dynamics::Transform<double>& pose) {
  pinocchio::forwardKinematics(model(), data_, positions(q));
  const pinocchio::SE3& X = pinocchio::updateFramePlacement(model(), data_, frameOf(tip));
  pose.R = X.rotation();
  pose.p = X.translation();
}

void PinocchioWorkspace::tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) {
  pinocchio::computeFrameJacobian(model(), data_, positions(q), frameOf(tip),
                                  pinocchio::LOCAL_WORLD_ALIGNED, emptyJacobian());
  writeJacobian(J);
}

void PinocchioWorkspace::tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q,
                                               const ConstVectorRef& qd, MatrixRef dJ) {
  pinocchio::computeJointJacobiansTimeVariation(model(), data_, positions(q), motion(qd, qd_));
  pinocchio::updateFramePlacement(model(), data_, frameOf(tip));
  pinocchio::getFrameJacobianTimeVariation(model(), data_, frameOf(tip),
                                           pinocchio::LOCAL_WORLD_ALIGNED, emptyJacobian());
  writeJacobian(dJ);
}

void PinocchioWorkspace::externalTorques(std::size_t tip, const ConstVectorRef& q,
                                         WrenchFrame frame, const ConstVectorRef& wrench,
                                         VectorRef tau) {
  const auto axes = frame == WrenchFrame::kTip ? pinocchio::LOCAL : pinocchio::LOCAL_WORLD_ALIGNED;
  pinocchio::computeFrameJacobian(model(), data_, positions(q), frameOf(tip), axes,
                                  emptyJacobian());
  tau_.noalias() = jacobian_.transpose().lazyProduct(wrench);
  write(tau_, tau);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
