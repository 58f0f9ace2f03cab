// SPDX-License-Identifier: Apache-2.0
/// @file
/// For solvers over a library that keeps state: only the calls of the library are left to add.
///
///     class MySolver : public inverse_dynamics_solver::PooledSolver {
///       WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const override {
///         return [model = toMyLibrary(chain)] { return std::make_unique<MyWorkspace>(model); };
///       }
///     };
#pragma once

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/friction_laws/coefficients.hpp>
#include <chain_dynamics/model.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/changeable_robot.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/kinematics.hpp"
#include "inverse_dynamics_solver/workspace_pool.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// A library's algorithms of one robot, and all that they write to. One thread at a time.
///
/// Arguments, order and units are those of the solver's methods of the same name; n numbers each, H
/// n x n; sizes are checked before. Real time: no allocation, lock, exception or system call.
class Workspace {
 public:
  virtual ~Workspace() = default;
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  virtual void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) = 0;
  virtual void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) = 0;
  virtual void gravityVector(const ConstVectorRef& q, VectorRef g) = 0;
  /// Without friction.
  virtual void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                       VectorRef tau) = 0;

 protected:
  Workspace() = default;
};

/// A workspace that computes tips, too: as the compute... of Kinematics and ExternalWrench. Of a chain
/// the index of the tip is zero.
class TipWorkspace : public Workspace {
 public:
  virtual void tipPose(std::size_t tip, const ConstVectorRef& q,
                       chain_dynamics::Transform<double>& pose) = 0;
  virtual void tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) = 0;
  virtual void tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q,
                                     const ConstVectorRef& qd, MatrixRef dJ) = 0;
  virtual void externalTorques(std::size_t tip, const ConstVectorRef& q, WrenchFrame frame,
                               const ConstVectorRef& wrench, VectorRef tau) = 0;
};

class PooledTip;

/// A robot made ready to compute with: workspaces that all hold the same one.
struct PooledRobot {
  std::unique_ptr<WorkspacePool<Workspace>> pool;
};

/// Solver of the rigid-body dynamics of the chain between `root` and `tip` of a robot description,
/// by a library that keeps state: each call borrows a workspace of its own. Several tips, or joints
/// that mimic others, make it a tree [chain_dynamics/mechanism.hpp], for solvers that compute these.
///
/// Friction: that of the robot description, where the parameter `urdf_friction` is true.
///
/// Parameters: those of Configuration, and below the same namespace `max_threads`: how many threads
/// may compute at the same time without allocating (see readMaxThreads()). Calls beyond it at the
/// same time are right too, but make a workspace on the heap.
///
/// Real time (within max_threads): no allocation, lock, exception or system call. Threads: safe.
class PooledSolver : public InverseDynamicsSolver, public ChangeableRobot<PooledRobot> {
 protected:
  using WorkspaceMaker = std::function<std::unique_ptr<Workspace>()>;

  /// Makes workspaces of a chain; many threads may call it at the same time.
  virtual WorkspaceMaker workspaceMaker(const chain_dynamics::Chain& chain) const = 0;

  /// The same of a model with branches; by default refused.
  virtual WorkspaceMaker treeWorkspaceMaker(const chain_dynamics::Model& tree) const;

  /// For treeWorkspaceMaker(): TipWorkspaces that add what workspaces of the branches' chains compute.
  WorkspaceMaker sumOfChains(const chain_dynamics::Model& tree) const;

  /// @name For the capabilities of a solver
  /// @{

  /// A workspace of the calling thread's own until the end of the scope, as the class that
  /// workspaceMaker() makes: `borrow<MyWorkspace>()->tipJacobian(q, J)`. Once per call of the solver.
  template <class MyWorkspace>
  class Borrowed {
   public:
    explicit Borrowed(const PooledSolver& solver)
        : robot_(solver.currentRobot()), lease_(robot_->pool->acquire()) {}
    MyWorkspace* operator->() const { return static_cast<MyWorkspace*>(lease_.operator->()); }

   private:
    Published<PooledRobot>::Reader robot_;
    WorkspacePool<Workspace>::Lease lease_;
  };
  template <class MyWorkspace>
  Borrowed<MyWorkspace> borrow() const {
    return Borrowed<MyWorkspace>(*this);
  }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }

  bool isTree() const { return !bare_->branches.empty(); }

  /// Accelerations of a tree: solves `H qdd = tau - f - C qd - g`.
  void computeTreeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& tau, VectorRef qdd) const;

  /// Adds the derivatives of the friction torques to the diagonal of `dtau_dqd`.
  void addFrictionSlopes(const ConstVectorRef& qd, MatrixRef dtau_dqd) const;

  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef f) const final;
  /// @}

 private:
  friend class PooledTip;

  JointInfo configure(const Configuration& configuration) final;
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const final;
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const final;
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const final;
  void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                                VectorRef c, VectorRef g) const final;
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const final;
  bool inertiaIsPhysicalImpl() const final { return inertia_is_physical_; }

  void addFriction(const ConstVectorRef& qd, VectorRef f) const;

  std::unique_ptr<const PooledRobot> robotUnder(const Conditions& conditions) const final;
  std::unique_ptr<const PooledRobot> robotOf(const chain_dynamics::Model& model,
                                             std::size_t max_threads) const;

  std::unique_ptr<const chain_dynamics::Model> bare_;   // without payloads
  std::vector<std::shared_ptr<const PooledTip>> tips_;  // by tipNames()
  std::size_t max_threads_ = 0;
  std::vector<chain_dynamics::FrictionForm> friction_;  // empty: none; independent of load
  bool inertia_is_physical_ = false;
};

/// Kinematics and wrenches of a tip, by a PooledSolver whose workspaces are TipWorkspaces. Such a solver
/// derives from it for its first tip: `MySolver() : PooledTip(*this, 0) {}`.
class PooledTip : public Kinematics, public ExternalWrench {
 public:
  PooledTip(const PooledSolver& solver, std::size_t tip) : solver_(solver), tip_(tip) {}

 protected:
  const InverseDynamicsSolver& torqueSolver() const override { return solver_; }
  const Kinematics& kinematicsOfTip(std::size_t tip) const final { return *solver_.tips_[tip]; }
  const ExternalWrench& externalWrenchAtTip(std::size_t tip) const final {
    return *solver_.tips_[tip];
  }
  void computeTipPose(const ConstVectorRef& q, chain_dynamics::Transform<double>& pose) const final;
  void computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const final;
  void computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    MatrixRef dJ) const final;
  void computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                              const ConstVectorRef& wrench, VectorRef tau) const final;

 private:
  const PooledSolver& solver_;
  std::size_t tip_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
