// SPDX-License-Identifier: Apache-2.0

#include "model_branches.hpp"

#include <cstddef>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/gravity_vector.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace sums {
void torques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
             const ConstVectorRef& qdd, VectorRef tau) {
  sumOfVectors(model.branches, tau, [&](const Branch& branch, VectorRef tau_b) {
    chain_dynamics::torques(
        branch.chain, internal::OwnParameters(), ConstVectorRef(positionsOf(branch, q)),
        ConstVectorRef(motionOf(branch, qd)), ConstVectorRef(motionOf(branch, qdd)), tau_b);
  });
}

void inertiaMatrix(const Model& model, const ConstVectorRef& q, MatrixRef H) {
  sumOfMatrices(model.branches, H, [&](const Branch& branch, MatrixRef H_b) {
    chain_dynamics::inertiaMatrix(branch.chain, internal::OwnParameters(),
                                  ConstVectorRef(positionsOf(branch, q)), H_b);
  });
}

void coriolisVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef c) {
  sumOfVectors(model.branches, c, [&](const Branch& branch, VectorRef c_b) {
    chain_dynamics::coriolisVector(branch.chain, internal::OwnParameters(),
                                   ConstVectorRef(positionsOf(branch, q)),
                                   ConstVectorRef(motionOf(branch, qd)), c_b);
  });
}

void coriolisMatrix(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    MatrixRef C) {
  sumOfMatrices(model.branches, C, [&](const Branch& branch, MatrixRef C_b) {
    chain_dynamics::coriolisMatrix(branch.chain, internal::OwnParameters(),
                                   ConstVectorRef(positionsOf(branch, q)),
                                   ConstVectorRef(motionOf(branch, qd)), C_b);
  });
}

void gravityVector(const Model& model, const ConstVectorRef& q, VectorRef g) {
  sumOfVectors(model.branches, g, [&](const Branch& branch, VectorRef g_b) {
    chain_dynamics::gravityVector(branch.chain, internal::OwnParameters(),
                                  ConstVectorRef(positionsOf(branch, q)), g_b);
  });
}

void torqueDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                       MatrixRef dtau_dqdd) {
  dtau_dq.setZero();
  dtau_dqd.setZero();
  dtau_dqdd.setZero();
  for (const Branch& branch : model.branches) {
    const Eigen::Index m = branch.chain.jointCount();
    BranchMatrix by_q(m, m), by_qd(m, m), by_qdd(m, m);
    chain_dynamics::torqueDerivatives(
        branch.chain, internal::OwnParameters(), ConstVectorRef(positionsOf(branch, q)),
        ConstVectorRef(motionOf(branch, qd)), ConstVectorRef(motionOf(branch, qdd)),
        MatrixRef(by_q), MatrixRef(by_qd), MatrixRef(by_qdd));
    addMatrix(branch.S, by_q, dtau_dq);
    addMatrix(branch.S, by_qd, dtau_dqd);
    addMatrix(branch.S, by_qdd, dtau_dqdd);
  }
}

double kineticEnergy(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd) {
  double sum = 0;
  for (const Branch& branch : model.branches) {
    sum += chain_dynamics::kineticEnergy(branch.chain, ConstVectorRef(positionsOf(branch, q)),
                                         ConstVectorRef(motionOf(branch, qd)));
  }
  return sum;
}

double potentialEnergy(const Model& model, const ConstVectorRef& q) {
  double sum = 0;
  for (const Branch& branch : model.branches) {
    sum += chain_dynamics::potentialEnergy(branch.chain, ConstVectorRef(positionsOf(branch, q)));
  }
  return sum;
}

void addGravityDerivatives(const Model& model, const ConstVectorRef& q,
                           const ConstVectorRef& factors, MatrixRef dtau_dq) {
  BranchMatrix dg_dq = BranchMatrix::Zero(q.size(), q.size());
  for (const Branch& branch : model.branches) {
    const Eigen::Index m = branch.chain.jointCount();
    BranchMatrix of_branch(m, m);
    const auto of_positions = [&](const auto& varied, auto& g) {
      chain_dynamics::gravityVector(branch.chain, varied, g);
    };
    differentiate(positionsOf(branch, q), of_positions, of_branch);
    addMatrix(branch.S, of_branch, dg_dq);
  }
  for (Eigen::Index j = 0; j < q.size(); ++j) dtau_dq.row(j) += factors[j] * dg_dq.row(j);
}

}  // namespace sums
}  // namespace v2
}  // namespace chain_dynamics
