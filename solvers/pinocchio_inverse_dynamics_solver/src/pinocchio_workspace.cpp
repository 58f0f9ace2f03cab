// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_workspace.hpp"

#include <algorithm>
#include <chain_dynamics/mechanism.hpp>
#include <memory>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <utility>

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

PinocchioWorkspace::PinocchioWorkspace(std::shared_ptr<const Models> models)
    : models_(std::move(models)),
      data_(models_->with_gravity),
      jacobian_(Data::Matrix6x::Zero(6, models_->with_gravity.nv)),
      zero_(Eigen::VectorXd::Zero(models_->with_gravity.nv)),
      q_(zero_),
      qd_(zero_),
      qdd_(zero_),
      tau_(zero_) {
  // Second derivatives, which nobody asks for: 0.9 GB of a chain of 300 joints.
  for (Data::Tensor3x* cube : {&data_.kinematic_hessians, &data_.d2tau_dqdq, &data_.d2tau_dvdv,
                               &data_.d2tau_dqdv, &data_.d2tau_dadq}) {
    cube->resize(0, 0, 0);
  }
}

ConstVectorRef PinocchioWorkspace::positions(const ConstVectorRef& q) {
  if (isChain()) return q;
  q_ = Eigen::Map<const Eigen::VectorXd>(models_->s.data(), q_.size());
  addMotion(models_->S, q, q_);
  return q_;
}

ConstVectorRef PinocchioWorkspace::motion(const ConstVectorRef& x, Eigen::VectorXd& memory) const {
  if (isChain()) return x;
  memory.setZero();
  addMotion(models_->S, x, memory);
  return memory;
}

void PinocchioWorkspace::write(const Eigen::VectorXd& of_joints, VectorRef tau) const {
  if (isChain()) {
    tau = of_joints;
    return;
  }
  tau.setZero();
  addTorques(models_->S, of_joints, tau);
}

void PinocchioWorkspace::writeJacobian(MatrixRef J) const {
  if (isChain()) {
    J = jacobian_;
    return;
  }
  J.setZero();
  addJacobian(models_->S, jacobian_, J);
}

void PinocchioWorkspace::writeInertia(MatrixRef H) const {
  if (isChain()) {
    H.triangularView<Eigen::Upper>() = data_.M;
    H.triangularView<Eigen::StrictlyLower>() = data_.M.transpose();
    return;
  }
  H.setZero();
  const auto entry = [this](Eigen::Index i, Eigen::Index j) {
    return data_.M(std::min(i, j), std::max(i, j));
  };
  addMatrix(models_->S, entry, H);
}

void PinocchioWorkspace::inertiaMatrix(const ConstVectorRef& q, MatrixRef H) {
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
  pinocchio::crba(model(), data_, positions(q), pinocchio::Convention::LOCAL);
#else
  pinocchio::crba(model(), data_, positions(q));
#endif
  writeInertia(H);
}

void PinocchioWorkspace::coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        VectorRef c) {
  write(pinocchio::nonLinearEffects(models_->without_gravity, data_, positions(q), motion(qd, qd_)),
        c);
}

void PinocchioWorkspace::gravityVector(const ConstVectorRef& q, VectorRef g) {
  write(pinocchio::computeGeneralizedGravity(model(), data_, positions(q)), g);
}

void PinocchioWorkspace::torques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                 const ConstVectorRef& qdd, VectorRef tau) {
  write(pinocchio::rnea(model(), data_, positions(q), motion(qd, qd_), motion(qdd, qdd_)), tau);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
