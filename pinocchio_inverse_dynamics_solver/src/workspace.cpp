// SPDX-License-Identifier: Apache-2.0
#include "workspace.hpp"

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <utility>

namespace pinocchio_inverse_dynamics_solver {

Workspace::Workspace(std::shared_ptr<const Models> models)
    : models_(std::move(models)), data_(models_->with_gravity) {}

void Workspace::inertiaMatrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> H) {
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
  pinocchio::crba(models_->with_gravity, data_, q, pinocchio::Convention::LOCAL);
#else
  pinocchio::crba(models_->with_gravity, data_, q);
#endif
  // Only the upper triangle is written.
  H.triangularView<Eigen::Upper>() = data_.M;
  H.triangularView<Eigen::StrictlyLower>() = data_.M.transpose();
}

void Workspace::coriolisVector(const Vector& q, const Vector& qd, Eigen::Ref<Eigen::VectorXd> c) {
  c = pinocchio::nonLinearEffects(models_->without_gravity, data_, q, qd);
}

void Workspace::gravityVector(const Vector& q, Eigen::Ref<Eigen::VectorXd> g) {
  g = pinocchio::computeGeneralizedGravity(models_->with_gravity, data_, q);
}

void Workspace::torques(const Vector& q, const Vector& qd, const Vector& qdd,
                        Eigen::Ref<Eigen::VectorXd> tau) {
  tau = pinocchio::rnea(models_->with_gravity, data_, q, qd, qdd);
}

}  // namespace pinocchio_inverse_dynamics_solver
