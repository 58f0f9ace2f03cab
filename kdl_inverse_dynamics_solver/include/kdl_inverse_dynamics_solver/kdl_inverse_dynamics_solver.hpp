// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of a URDF, computed by Orocos KDL.
///
///     auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
///     solver->initialize({{"ids.tip", "tool0"}}, "ids", urdf);
///     Eigen::VectorXd tau = solver->getTorques(q, qd, qdd);
#pragma once

#include <memory>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/workspace_pool.hpp"

namespace kdl_inverse_dynamics_solver {

using inverse_dynamics_solver::Configuration;
using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

class Workspace;

/// Solver of the rigid-body dynamics of the chain between `root` and `tip` of a robot description.
///
/// Torques by KDL's recursive Newton-Euler solver, H, C qd and g by its ChainDynParam [Featherstone
/// 2008, ch. 5 and 6]. No friction: getFrictionVector() is zero.
///
/// Parameters: those of Configuration, and below the same namespace
/// `max_threads`: how many threads may compute at the same time without allocating (see
/// readMaxThreads()).
///
/// KDL's solvers keep state, so each call borrows a workspace of its own. Calls beyond
/// `max_threads` at the same time are right too, but make a workspace on the heap.
///
/// Real time (within max_threads): no allocation, lock, exception or system call. Threads: safe.
class InverseDynamicsSolverKDL : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  InverseDynamicsSolverKDL();
  ~InverseDynamicsSolverKDL() override;

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

}  // namespace kdl_inverse_dynamics_solver
