// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Orocos KDL.
///
///     auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/forward_dynamics.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::VectorRef;

/// Torques by KDL's recursive Newton-Euler solver, H, C qd and g by its ChainDynParam [Featherstone
/// 2008, ch. 5 and 6], the tip by ChainFkSolverPos_recursive, ChainJntToJacSolver and
/// ChainJntToJacDotSolver, accelerations by ChainFdSolver_RNE. Trees are the sums of the chains to their
/// tips, each by these solvers; their accelerations are solved from H and torques. KDL's solvers keep
/// state: parameters and promises are those of PooledSolver. (KDL has no Coriolis matrix, energies,
/// derivatives or regressor.)
class InverseDynamicsSolverKDL : public inverse_dynamics_solver::PooledSolver,
                                 public inverse_dynamics_solver::PooledTip,
                                 public inverse_dynamics_solver::ForwardDynamics {
 public:
  InverseDynamicsSolverKDL() : PooledTip(*this, 0) {}

  using ExternalWrench::getTorques;
  using ExternalWrench::getTorquesBatch;
  using InverseDynamicsSolver::getTorques;
  using InverseDynamicsSolver::getTorquesBatch;

 protected:
  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const override;
  WorkspaceMaker treeWorkspaceMaker(const chain_dynamics::Model& tree) const override {
    return sumOfChains(tree);
  }
  void computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                            const ConstVectorRef& tau, VectorRef qdd) const override;
};

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
