// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/friction_memory.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

FrictionMemory::~FrictionMemory() = default;

chain_dynamics::FrictionState FrictionMemory::frictionState() const {
  jointsFor("frictionState");
  return frictionStateImpl();
}

chain_dynamics::FrictionState frictionState(const InverseDynamicsSolver& solver) {
  const auto* const memory = dynamic_cast<const FrictionMemory*>(&solver);
  return memory != nullptr ? memory->frictionState() : chain_dynamics::FrictionState();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
