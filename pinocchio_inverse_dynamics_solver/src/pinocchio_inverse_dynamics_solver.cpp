// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

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

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
