// SPDX-License-Identifier: Apache-2.0
#include "sum_of_chains.hpp"

#include <Eigen/Core>
#include <cstddef>

#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/spatial.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

using chain_dynamics::Branch;
using chain_dynamics::motionOf;
using chain_dynamics::positionsOf;

namespace {

/// Of one branch.
using BranchJacobian =
    Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, chain_dynamics::kMostBranchJoints>;

}  // namespace

void SumOfChains::inertiaMatrix(const ConstVectorRef& q, MatrixRef H) {
  sumOfMatrices(*branches_, H, [&](const Branch& branch, MatrixRef H_b) {
    of(branch).inertiaMatrix(positionsOf(branch, q), H_b);
  });
}

void SumOfChains::coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) {
  sumOfVectors(*branches_, c, [&](const Branch& branch, VectorRef c_b) {
    of(branch).coriolisVector(positionsOf(branch, q), motionOf(branch, qd), c_b);
  });
}

void SumOfChains::gravityVector(const ConstVectorRef& q, VectorRef g) {
  sumOfVectors(*branches_, g, [&](const Branch& branch, VectorRef g_b) {
    of(branch).gravityVector(positionsOf(branch, q), g_b);
  });
}

void SumOfChains::torques(const ConstVectorRef& q, const ConstVectorRef& qd,
                          const ConstVectorRef& qdd, VectorRef tau) {
  sumOfVectors(*branches_, tau, [&](const Branch& branch, VectorRef tau_b) {
    of(branch).torques(positionsOf(branch, q), motionOf(branch, qd), motionOf(branch, qdd), tau_b);
  });
}

void SumOfChains::tipPose(std::size_t tip, const ConstVectorRef& q,
                          chain_dynamics::Transform<double>& pose) {
  withTip(tip).tipPose(0, positionsOf((*branches_)[tip], q), pose);
}

void SumOfChains::tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) {
  const Branch& branch = (*branches_)[tip];
  BranchJacobian J_b(6, branch.chain.jointCount());
  withTip(tip).tipJacobian(0, positionsOf(branch, q), J_b);
  J.setZero();
  addJacobian(branch.S, J_b, J);
}

void SumOfChains::tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q,
                                        const ConstVectorRef& qd, MatrixRef dJ) {
  const Branch& branch = (*branches_)[tip];
  BranchJacobian dJ_b(6, branch.chain.jointCount());
  withTip(tip).tipJacobianDerivative(0, positionsOf(branch, q), motionOf(branch, qd), dJ_b);
  dJ.setZero();
  addJacobian(branch.S, dJ_b, dJ);
}

void SumOfChains::externalTorques(std::size_t tip, const ConstVectorRef& q, WrenchFrame frame,
                                  const ConstVectorRef& wrench, VectorRef tau) {
  const Branch& branch = (*branches_)[tip];
  chain_dynamics::BranchVector tau_b(branch.chain.jointCount());
  withTip(tip).externalTorques(0, positionsOf(branch, q), frame, wrench, tau_b);
  tau.setZero();
  addTorques(branch.S, tau_b, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
