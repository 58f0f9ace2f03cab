// SPDX-License-Identifier: Apache-2.0
#include "chain_dynamics/share_states.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <vector>

namespace chain_dynamics {
inline namespace v2 {

void shareAmongThreads(Eigen::Index count, Eigen::Index threads,
                       const std::function<void(Eigen::Index, Eigen::Index)>& compute) {
  std::atomic<Eigen::Index> next{0};
  const auto take_parts = [&] {
    for (Eigen::Index first = 0; (first = next.fetch_add(kStatesOfAPart)) < count;) {
      compute(first, std::min(kStatesOfAPart, count - first));
    }
  };
  // A future waits for its thread when it is destroyed.
  constexpr auto kThreadIfThereIsOne = std::launch::async | std::launch::deferred;
  std::vector<std::future<void>> others;
  others.reserve(static_cast<std::size_t>(threads - 1));
  for (Eigen::Index i = 1; i < threads; ++i) {
    others.push_back(std::async(kThreadIfThereIsOne, take_parts));
  }
  take_parts();
  for (std::future<void>& other : others) other.get();
}

}  // namespace v2
}  // namespace chain_dynamics
