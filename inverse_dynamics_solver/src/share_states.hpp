// SPDX-License-Identifier: Apache-2.0
/// @file
/// Shares the states of a batch among threads.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>

namespace inverse_dynamics_solver {

/// A thread is worth its start from this many states on: starting and joining one takes tens of
/// microseconds, and so do this many states of the fastest solver.
constexpr Eigen::Index kLeastStatesOfAThread = 2048;

/// shareStates() where there are enough states for `parts` > 1 threads.
void shareAmongThreads(Eigen::Index count, Eigen::Index parts,
                       const std::function<void(Eigen::Index first, Eigen::Index size)>& compute);

/// Calls compute(first, size) for contiguous parts of `count` states, which together are all of
/// them, on up to `threads` threads, the caller's one of them; for one thread without allocation.
///
/// Returns when all have ended. Where the system refuses a thread, the caller's does its part.
/// Throws what a part throws: of several, that of the first.
template <typename Compute>
void shareStates(Eigen::Index count, std::int64_t threads, const Compute& compute) {
  const Eigen::Index parts =
      std::min(static_cast<Eigen::Index>(threads), count / kLeastStatesOfAThread);
  if (parts <= 1) return compute(0, count);
  shareAmongThreads(count, parts, std::cref(compute));
}

}  // namespace inverse_dynamics_solver
