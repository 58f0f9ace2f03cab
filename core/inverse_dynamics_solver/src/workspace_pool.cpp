// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/workspace_pool.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>

namespace inverse_dynamics_solver {
inline namespace v2 {

std::size_t readMaxThreads(const Configuration& configuration) {
  constexpr std::int64_t kMost = 4096;
  // A thread that is interrupted within a call keeps its workspace: more than one per processor is
  // needed.
  const std::int64_t standard = std::max<std::int64_t>(16, std::thread::hardware_concurrency());
  const auto threads = configuration.get<std::int64_t>("max_threads").value_or(standard);
  if (threads < 1 || threads > kMost) {
    configuration.refuse("max_threads", "1 to " + std::to_string(kMost), std::to_string(threads),
                         "give the number of threads that compute at the same time");
  }
  return static_cast<std::size_t>(threads);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
