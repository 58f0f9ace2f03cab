// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: friction that grows with the load that joints carry.
///
///     if (!frictionDependsOnPosition(*solver)) {
///       Eigen::VectorXd f = solver->getFrictionVector(qd);
///     }
#pragma once

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Of solvers whose friction may depend on the position. Without this capability it doesn't.
class LoadFriction : public Capability {
 public:
  ~LoadFriction() override;

  /// Whether friction grows with the gravity torques that joints carry: then it must be asked for with
  /// the position, and also depends on payloads and gravity. `getFrictionVector(q, qd)` serves every
  /// solver.
  bool frictionDependsOnPosition() const;

 protected:
  /// Called after a successful initialize(). Where it is true, computeFriction() is never called
  /// without positions.
  virtual bool frictionDependsOnPositionImpl() const = 0;
};

/// The same of any solver.
bool frictionDependsOnPosition(const InverseDynamicsSolver& solver);

}  // namespace v2
}  // namespace inverse_dynamics_solver
