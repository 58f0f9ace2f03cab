// SPDX-License-Identifier: Apache-2.0

// Derivatives and what is made of them, regressor, accelerations and energies by Pinocchio.

#include <chain_dynamics/mechanism.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

#include "pinocchio_workspace.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

void PinocchioWorkspace::torqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                           const ConstVectorRef& qdd, MatrixRef dtau_dq,
                                           MatrixRef dtau_dqd, MatrixRef dtau_dqdd) {
  pinocchio::computeRNEADerivatives(model(), data_, positions(q), motion(qd, qd_),
                                    motion(qdd, qdd_));
  writeMatrix(data_.dtau_dq, dtau_dq);
  writeMatrix(data_.dtau_dv, dtau_dqd);
  writeInertia(dtau_dqdd);
}

/// By definition that of Christoffel's symbols, whatever Pinocchio's version. (For joints of one degree
/// of freedom computeCoriolisMatrix() of Pinocchio 4 gives the same.)
void PinocchioWorkspace::coriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        MatrixRef C) {
  pinocchio::computeRNEADerivatives(models_->without_gravity, data_, positions(q), motion(qd, qd_),
                                    zero_);
  writeMatrix(data_.dtau_dv, C);
  C *= 0.5;
}

void PinocchioWorkspace::regressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                                   const ConstVectorRef& qdd, MatrixRef Y) {
  pinocchio::computeJointTorqueRegressor(model(), data_, positions(q), motion(qd, qd_),
                                         motion(qdd, qdd_));
  const auto& of_joints = data_.jointTorqueRegressor;
  if (isChain()) {
    Y = of_joints;
  } else {
    Y.setZero();
    Eigen::Index from = 0;
    for (const Eigen::Index link : models_->link) {
      for (Eigen::Index to = 10 * link; to < 10 * link + 10; ++to) {
        addTorques(models_->S, of_joints.col(from++), Y.col(to));
      }
    }
  }
  // Pinocchio's order of the moments is Ixx Ixy Iyy Ixz Iyz Izz.
  for (Eigen::Index link = 0; link < Y.cols(); link += 10) Y.col(link + 6).swap(Y.col(link + 7));
}

void PinocchioWorkspace::accelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                       const ConstVectorRef& tau, VectorRef qdd) {
#if PINOCCHIO_VERSION_AT_LEAST(3, 0, 0)
  qdd = pinocchio::aba(model(), data_, q, qd, tau, pinocchio::Convention::LOCAL);
#else
  qdd = pinocchio::aba(model(), data_, q, qd, tau);
#endif
}

double PinocchioWorkspace::kineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) {
  return pinocchio::computeKineticEnergy(model(), data_, positions(q), motion(qd, qd_));
}

double PinocchioWorkspace::potentialEnergy(const ConstVectorRef& q) {
  return pinocchio::computePotentialEnergy(model(), data_, positions(q));
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
