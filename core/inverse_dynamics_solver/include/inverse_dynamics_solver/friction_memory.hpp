// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: friction that remembers where the robot has come from.
///
///     chain_dynamics::FrictionState state = frictionState(*solver);   // one for each motion
///     state.move(q);                                     // at every sample, in the order of time
///     solver->getTorques(q, qd, qdd, tau);
///     state.addTo(qd, tau);                              // tau with friction after this motion
#pragma once

#include <chain_dynamics/friction_state.hpp>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Of solvers whose friction may preslide. Friction and torques of a solver are the limit without
/// memory; a state, which the caller owns, adds the rest [chain_dynamics/friction_state.hpp].
class FrictionMemory : public Capability {
 public:
  ~FrictionMemory() override;

  /// A state that knows nothing of the motion so far. Of friction that remembers nothing, and with the
  /// parameter `friction` false, one that adds nothing.
  chain_dynamics::FrictionState frictionState() const;

 protected:
  /// Called after a successful initialize().
  virtual chain_dynamics::FrictionState frictionStateImpl() const = 0;
};

/// The same of any solver; without the capability, a state that adds nothing.
chain_dynamics::FrictionState frictionState(const InverseDynamicsSolver& solver);

}  // namespace v2
}  // namespace inverse_dynamics_solver
