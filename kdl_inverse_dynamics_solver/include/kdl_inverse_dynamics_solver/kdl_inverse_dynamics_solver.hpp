// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Orocos KDL.
///
///     auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

/// Torques by KDL's recursive Newton-Euler solver, H, C qd and g by its ChainDynParam [Featherstone
/// 2008, ch. 5 and 6]. KDL's solvers keep state: parameters and promises are those of PooledSolver.
class InverseDynamicsSolverKDL : public inverse_dynamics_solver::PooledSolver {
 protected:
  WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const override;
};

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
