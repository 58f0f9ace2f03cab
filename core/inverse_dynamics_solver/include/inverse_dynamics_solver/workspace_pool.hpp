// SPDX-License-Identifier: Apache-2.0
/// @file
/// For solvers over a library that keeps state: a pool of workspaces, so that
/// many threads may compute at once, without lock or allocation.
///
///     WorkspacePool<Workspace> pool(readMaxThreads(configuration),
///                                   [&] { return std::make_unique<Workspace>(model); });
///     const auto workspace = pool.acquire();   // this thread's own until the end of the scope
///     workspace->torques(q, qd, qdd, tau);
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/configuration.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The parameter `max_threads`: how many threads compute at the same time without allocating; by
/// default the number of processors, at least 16.
///
/// Throws InvalidParameterValueException: not an integer of 1 to 4096.
std::size_t readMaxThreads(const Configuration& configuration);

/// Workspaces that threads borrow. Without lock: a flag per workspace.
///
/// @tparam Workspace  what one thread computes with at a time.
template <class Workspace>
class WorkspacePool {
 public:
  using Maker = std::function<std::unique_ptr<Workspace>()>;

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
  /// @param make   gives a workspace; called by any thread that finds all of them in use.
  WorkspacePool(std::size_t count, Maker make) : make_(std::move(make)), slots_(count) {
    for (Slot& slot : slots_) slot.workspace = make_();
  }

  /// A free workspace; if all are in use, a new one on the heap. Threads: safe.
  Lease acquire() {
    // Threads begin at different places, and so seldom meet.
    const std::size_t start = threadNumber();
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      Slot& slot = slots_[(start + i) % slots_.size()];
      if (!slot.busy.test_and_set(std::memory_order_acquire)) {
        return Lease(slot.workspace.get(), &slot.busy);
      }
    }
    return Lease(make_());
  }

 private:
  // A cache line each, so that threads don't slow each other down.
  struct alignas(64) Slot {
    std::atomic_flag busy = ATOMIC_FLAG_INIT;
    std::unique_ptr<Workspace> workspace;
  };

  /// A number that differs between threads. (No thread_local index: its first use could allocate.)
  static std::size_t threadNumber() {
    const std::uint64_t id = std::hash<std::thread::id>()(std::this_thread::get_id());
    return static_cast<std::size_t>((id * 0x9E3779B97F4A7C15U) >> 32U);
  }

  const Maker make_;
  std::vector<Slot> slots_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
