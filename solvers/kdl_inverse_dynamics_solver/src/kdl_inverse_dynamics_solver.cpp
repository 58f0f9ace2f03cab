// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include <chain_dynamics/chain.hpp>
#include <memory>

#include "kdl_chain.hpp"
#include "kdl_workspace.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

auto InverseDynamicsSolverKDL::workspaceMaker(const chain_dynamics::Chain& chain) const
    -> WorkspaceMaker {
  return [chain] {
    return std::make_unique<KdlWorkspace>(toKdl(chain), toKdl(chain.gravity()), toKdl(chain.tip()));
  };
}

void InverseDynamicsSolverKDL::computeAccelerations(const ConstVectorRef& q,
                                                    const ConstVectorRef& qd,
                                                    const ConstVectorRef& tau,
                                                    VectorRef qdd) const {
  if (isTree()) return computeTreeAccelerations(q, qd, tau, qdd);
  // qdd holds the torques without friction until then
  computeFriction(q, qd, qdd);
  qdd = tau - qdd;
  borrow<KdlWorkspace>()->accelerations(q, qd, qdd, qdd);
}

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
