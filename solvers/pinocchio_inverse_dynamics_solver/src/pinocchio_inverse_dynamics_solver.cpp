// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/model.hpp>
#include <memory>

#include "pinocchio_model.hpp"
#include "pinocchio_workspace.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

auto InverseDynamicsSolverPinocchio::workspaceMaker(const chain_dynamics::Chain& chain) const
    -> WorkspaceMaker {
  auto models = std::make_shared<const Models>(
      Models{toPinocchio(chain), toPinocchio(chain.withGravity(Eigen::Vector3d::Zero()))});
  return [models] { return std::make_unique<PinocchioWorkspace>(models); };
}

auto InverseDynamicsSolverPinocchio::treeWorkspaceMaker(const chain_dynamics::Model& tree) const
    -> WorkspaceMaker {
  auto models = std::make_shared<const Models>(toPinocchio(tree.branches));
  return [models] { return std::make_unique<PinocchioWorkspace>(models); };
}

void InverseDynamicsSolverPinocchio::computeCoriolisMatrix(const ConstVectorRef& q,
                                                           const ConstVectorRef& qd,
                                                           MatrixRef C) const {
  borrow<PinocchioWorkspace>()->coriolisMatrix(q, qd, C);
}

double InverseDynamicsSolverPinocchio::computeKineticEnergy(const ConstVectorRef& q,
                                                            const ConstVectorRef& qd) const {
  return borrow<PinocchioWorkspace>()->kineticEnergy(q, qd);
}

double InverseDynamicsSolverPinocchio::computePotentialEnergy(const ConstVectorRef& q) const {
  return borrow<PinocchioWorkspace>()->potentialEnergy(q);
}

void InverseDynamicsSolverPinocchio::computeTorqueDerivatives(const ConstVectorRef& q,
                                                              const ConstVectorRef& qd,
                                                              const ConstVectorRef& qdd,
                                                              MatrixRef dtau_dq, MatrixRef dtau_dqd,
                                                              MatrixRef dtau_dqdd) const {
  borrow<PinocchioWorkspace>()->torqueDerivatives(q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
  addFrictionSlopes(qd, dtau_dqd);
}

Eigen::Index InverseDynamicsSolverPinocchio::linkCountImpl() const {
  return borrow<PinocchioWorkspace>()->linkCount();
}

void InverseDynamicsSolverPinocchio::computeRegressor(const ConstVectorRef& q,
                                                      const ConstVectorRef& qd,
                                                      const ConstVectorRef& qdd,
                                                      MatrixRef Y) const {
  borrow<PinocchioWorkspace>()->regressor(q, qd, qdd, Y);
}

void InverseDynamicsSolverPinocchio::computeAccelerations(const ConstVectorRef& q,
                                                          const ConstVectorRef& qd,
                                                          const ConstVectorRef& tau,
                                                          VectorRef qdd) const {
  if (isTree()) return computeTreeAccelerations(q, qd, tau, qdd);
  // qdd holds the torques without friction until then
  computeFriction(q, qd, qdd);
  qdd = tau - qdd;
  borrow<PinocchioWorkspace>()->accelerations(q, qd, qdd, qdd);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
