// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/load_friction.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

LoadFriction::~LoadFriction() = default;

bool LoadFriction::frictionDependsOnPosition() const {
  jointsFor("frictionDependsOnPosition");
  return frictionDependsOnPositionImpl();
}

bool frictionDependsOnPosition(const InverseDynamicsSolver& solver) {
  const auto* const friction = dynamic_cast<const LoadFriction*>(&solver);
  return friction != nullptr && friction->frictionDependsOnPosition();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
