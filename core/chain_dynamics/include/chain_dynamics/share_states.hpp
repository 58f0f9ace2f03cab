// SPDX-License-Identifier: Apache-2.0
/// @file
/// Shares the states of a batch among threads.
///
///     shareStates(q.count, 4, [&](Eigen::Index first, Eigen::Index size) {
///       fast.gravityVectorBatch(q.middle(first, size), g.middle(first, size));
///     });
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>

namespace chain_dynamics {
inline namespace v2 {

/// States of one part of a batch. A thread is worth its start from so many on: starting and joining
/// one takes tens of microseconds, and so do this many states of the fastest solver.
constexpr Eigen::Index kStatesOfAPart = 2048;

/// shareStates() where there are enough states for `threads` > 1.
void shareAmongThreads(Eigen::Index count, Eigen::Index threads,
                       const std::function<void(Eigen::Index first, Eigen::Index size)>& compute);

/// Calls compute(first, size) for contiguous parts of `count` states, which together are all of
/// them, on up to `threads` threads, including the caller's; for one thread without allocation.
///
/// A thread that is done with a part takes the next one. Returns when all have ended. Where the
/// system refuses a thread, the others do its parts. Throws what a part throws, one of several.
template <typename Compute>
void shareStates(Eigen::Index count, std::int64_t threads, const Compute& compute) {
  const Eigen::Index worth_it = std::min<Eigen::Index>(threads, count / kStatesOfAPart);
  if (worth_it <= 1) return compute(0, count);
  shareAmongThreads(count, worth_it, std::cref(compute));
}

}  // namespace v2
}  // namespace chain_dynamics
