// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_workspace.hpp"

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
      zero_(Eigen::VectorXd::Zero(models_->with_gravity.nv)) {
  // Second derivatives, which nobody asks for: 0.9 GB of a chain of 300 joints.
  for (Data::Tensor3x* cube : {&data_.kinematic_hessians, &data_.d2tau_dqdq, &data_.d2tau_dvdv,
                               &data_.d2tau_dqdv, &data_.d2tau_dadq}) {
    cube->resize(0, 0, 0);
  }
}

void PinocchioWorkspace::inertiaMatrix(const ConstVectorRef& q, MatrixRef H) {
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
  pinocchio::crba(models_->with_gravity, data_, q, pinocchio::Convention::LOCAL);
#else
  pinocchio::crba(models_->with_gravity, data_, q);
#endif
  // Only the upper triangle is written.
  H.triangularView<Eigen::Upper>() = data_.M;
  H.triangularView<Eigen::StrictlyLower>() = data_.M.transpose();
}

void PinocchioWorkspace::coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        VectorRef c) {
  c = pinocchio::nonLinearEffects(models_->without_gravity, data_, q, qd);
}

void PinocchioWorkspace::gravityVector(const ConstVectorRef& q, VectorRef g) {
  g = pinocchio::computeGeneralizedGravity(models_->with_gravity, data_, q);
}

void PinocchioWorkspace::torques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                 const ConstVectorRef& qdd, VectorRef tau) {
  tau = pinocchio::rnea(models_->with_gravity, data_, q, qd, qdd);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
