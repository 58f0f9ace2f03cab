// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Pinocchio.
///
///     auto solver = SolverLoader().load(
///         "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/coriolis_matrix.hpp"
#include "inverse_dynamics_solver/energies.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/forward_dynamics.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"
#include "inverse_dynamics_solver/regressor.hpp"
#include "inverse_dynamics_solver/torque_derivatives.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

/// Torques by Pinocchio's `rnea`, H by its `crba`, C qd and g by `nonLinearEffects` and
/// `computeGeneralizedGravity` [Featherstone 2008, ch. 5 and 6]; the tip by its frames, derivatives
/// by `computeRNEADerivatives`, the Coriolis matrix as half of that by velocity, the rest by
/// `computeJointTorqueRegressor`, `aba` and its energies. A tree is Pinocchio's, with torques, matrices
/// and Jacobians seen from its coordinates; its accelerations are solved from H and torques. Pinocchio
/// writes to memory of its own: parameters and promises are those of PooledSolver.
class InverseDynamicsSolverPinocchio : public inverse_dynamics_solver::PooledSolver,
                                       public inverse_dynamics_solver::PooledTip,
                                       public inverse_dynamics_solver::CoriolisMatrix,
                                       public inverse_dynamics_solver::Energies,
                                       public inverse_dynamics_solver::TorqueDerivatives,
                                       public inverse_dynamics_solver::Regressor,
                                       public inverse_dynamics_solver::ForwardDynamics {
 public:
  InverseDynamicsSolverPinocchio() : PooledTip(*this, 0) {}

  using ExternalWrench::getTorques;
  using ExternalWrench::getTorquesBatch;
  using InverseDynamicsSolver::getTorques;
  using InverseDynamicsSolver::getTorquesBatch;

 protected:
  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const override;
  WorkspaceMaker treeWorkspaceMaker(const chain_dynamics::Model& tree) const override;
  void computeCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                             MatrixRef C) const override;
  double computeKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const override;
  double computePotentialEnergy(const ConstVectorRef& q) const override;
  void computeTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                                MatrixRef dtau_dqdd) const override;
  Eigen::Index linkCountImpl() const override;
  void computeRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                        const ConstVectorRef& qdd, MatrixRef Y) const override;
  void computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                            const ConstVectorRef& tau, VectorRef qdd) const override;
};

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
