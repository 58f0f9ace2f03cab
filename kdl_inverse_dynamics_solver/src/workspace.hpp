// SPDX-License-Identifier: Apache-2.0
/// @file
/// KDL's solvers with the memory they write to, and a pool of them, so that many threads may
/// compute at once.
///
///     const WorkspacePool::Lease workspace = pool.acquire();   // this thread's own until it goes
///     out of scope workspace->gravityVector(q, g);
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/jntarray.hpp>
#include <kdl/jntspaceinertiamatrix.hpp>
#include <memory>
#include <vector>

namespace kdl_inverse_dynamics_solver {

/// KDL's solvers of one chain and all that they write to. One thread at a time.
class Workspace {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  Workspace(const KDL::Chain& chain, const KDL::Vector& gravity);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  /// As the methods of the solver; n each, H n x n. No allocation.
  void inertiaMatrix(const Vector& q, Eigen::Ref<Eigen::MatrixXd> H);
  void coriolisVector(const Vector& q, const Vector& qd, Eigen::Ref<Eigen::VectorXd> c);
  void gravityVector(const Vector& q, Eigen::Ref<Eigen::VectorXd> g);
  void torques(const Vector& q, const Vector& qd, const Vector& qdd,
               Eigen::Ref<Eigen::VectorXd> tau);

 private:
  KDL::Chain chain_;  // KDL's solvers refer to it; its joints remember the last position
  KDL::ChainDynParam components_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::JntArray q_, qd_, qdd_, result_;
  KDL::JntSpaceInertiaMatrix H_;
  KDL::Wrenches no_forces_;
};

/// Workspaces that threads borrow. Without lock: a flag per workspace.
class WorkspacePool {
 public:
  /// A borrowed workspace; goes back at the end of the scope.
  class Lease {
   public:
    Lease(Workspace* workspace, std::atomic_flag* busy) : workspace_(workspace), busy_(busy) {}
    explicit Lease(std::unique_ptr<Workspace> own)
        : workspace_(own.get()), busy_(nullptr), own_(std::move(own)) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() {
      if (busy_ != nullptr) busy_->clear(std::memory_order_release);
    }
    Workspace* operator->() const { return workspace_; }

   private:
    Workspace* workspace_;
    std::atomic_flag* busy_;
    std::unique_ptr<Workspace> own_;
  };

  /// @param count  number of workspaces that are ready, at least one.
  WorkspacePool(const KDL::Chain& chain, const KDL::Vector& gravity, std::size_t count);

  /// A free workspace; if all are in use, a new one on the heap. Threads: safe.
  Lease acquire();

 private:
  // A cache line each, so that threads don't slow each other down.
  struct alignas(64) Slot {
    std::atomic_flag busy = ATOMIC_FLAG_INIT;
    std::unique_ptr<Workspace> workspace;
  };

  const KDL::Chain chain_;
  const KDL::Vector gravity_;
  std::vector<Slot> slots_;
};

}  // namespace kdl_inverse_dynamics_solver
