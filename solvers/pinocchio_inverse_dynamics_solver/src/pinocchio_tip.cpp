// SPDX-License-Identifier: Apache-2.0

// The tip's kinematics by Pinocchio.

#include <chain_dynamics/spatial.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "pinocchio_workspace.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

void PinocchioWorkspace::tipPose(const ConstVectorRef& q, chain_dynamics::Transform<double>& pose) {
  pinocchio::forwardKinematics(model(), data_, q);
  const pinocchio::SE3& X = pinocchio::updateFramePlacement(model(), data_, tip());
  pose.R = X.rotation();
  pose.p = X.translation();
}

void PinocchioWorkspace::tipJacobian(const ConstVectorRef& q, MatrixRef J) {
  pinocchio::computeFrameJacobian(model(), data_, q, tip(), pinocchio::LOCAL_WORLD_ALIGNED,
                                  jacobian_);
  J = jacobian_;
}

void PinocchioWorkspace::tipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                               MatrixRef dJ) {
  pinocchio::computeJointJacobiansTimeVariation(model(), data_, q, qd);
  pinocchio::updateFramePlacement(model(), data_, tip());
  pinocchio::getFrameJacobianTimeVariation(model(), data_, tip(), pinocchio::LOCAL_WORLD_ALIGNED,
                                           jacobian_);
  dJ = jacobian_;
}

void PinocchioWorkspace::externalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                         const ConstVectorRef& wrench, VectorRef tau) {
  const auto axes = frame == WrenchFrame::kTip ? pinocchio::LOCAL : pinocchio::LOCAL_WORLD_ALIGNED;
  pinocchio::computeFrameJacobian(model(), data_, q, tip(), axes, jacobian_);
  tau.noalias() = jacobian_.transpose().lazyProduct(wrench);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
