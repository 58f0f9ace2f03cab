// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Pinocchio.
///
///     auto solver = SolverLoader().load(
///         "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

/// Torques by Pinocchio's `rnea`, H by its `crba`, C qd and g by `nonLinearEffects` and
/// `computeGeneralizedGravity` [Featherstone 2008, ch. 5 and 6]. Pinocchio writes to memory of its
/// own: parameters and promises are those of PooledSolver.
class InverseDynamicsSolverPinocchio : public inverse_dynamics_solver::PooledSolver {
 protected:
  WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const override;
};

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
