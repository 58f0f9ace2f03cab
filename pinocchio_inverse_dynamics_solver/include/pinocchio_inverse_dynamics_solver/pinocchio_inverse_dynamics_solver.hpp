// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Pinocchio.
///
///     auto solver = SolverLoader().load(
///         "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include <memory>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/workspace_pool.hpp"

namespace pinocchio_inverse_dynamics_solver {

using inverse_dynamics_solver::Configuration;
using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

class Workspace;

/// Solver of the rigid-body dynamics of the chain between `root` and `tip` of a robot description.
///
/// Torques by Pinocchio's `rnea`, H by its `crba`, C qd and g by `nonLinearEffects` and
/// `computeGeneralizedGravity` [Featherstone 2008, ch. 5 and 6]. No friction: getFrictionVector()
/// is zero.
///
/// Parameters: those of Configuration, and below the same namespace `max_threads`: how many threads
/// may compute at the same time without allocating (see readMaxThreads()).
///
/// Pinocchio writes to memory of its own, so each call borrows a workspace. Calls beyond
/// `max_threads` at the same time are right too, but make a workspace on the heap.
///
/// Real time (within max_threads): no allocation, lock, exception or system call. Threads: safe.
class InverseDynamicsSolverPinocchio : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  InverseDynamicsSolverPinocchio();
  ~InverseDynamicsSolverPinocchio() override;

 protected:
  JointInfo configure(const Configuration& configuration) override;
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override;
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override;
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override;
  void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                                VectorRef c, VectorRef g) const override;
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const override;
  bool inertiaIsPhysicalImpl() const override { return inertia_is_physical_; }

 private:
  using Pool = inverse_dynamics_solver::WorkspacePool<Workspace>;
  std::unique_ptr<Pool> pool_;
  bool inertia_is_physical_ = false;
};

}  // namespace pinocchio_inverse_dynamics_solver
