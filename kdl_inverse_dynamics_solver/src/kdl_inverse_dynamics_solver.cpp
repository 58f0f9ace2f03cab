// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include "kdl_chain.hpp"
#include "kdl_workspace.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

auto InverseDynamicsSolverKDL::workspaceMaker(const chain_dynamics::Chain& chain) const
    -> WorkspaceMaker {
  return [chain] { return std::make_unique<KdlWorkspace>(toKdl(chain), toKdl(chain.gravity())); };
}

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
