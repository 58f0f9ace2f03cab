// SPDX-License-Identifier: Apache-2.0
#include "share_states.hpp"

#include <future>
#include <vector>

namespace inverse_dynamics_solver {

void shareAmongThreads(Eigen::Index count, Eigen::Index parts,
                       const std::function<void(Eigen::Index, Eigen::Index)>& compute) {
  // Part i begins at state i count / parts. A future waits for its part when it is destroyed.
  const auto begin = [&](Eigen::Index part) { return part * count / parts; };
  const auto compute_part = [&](Eigen::Index part) {
    compute(begin(part), begin(part + 1) - begin(part));
  };
  constexpr auto kThreadIfThereIsOne = std::launch::async | std::launch::deferred;
  std::vector<std::future<void>> others;
  others.reserve(static_cast<std::size_t>(parts - 1));
  for (Eigen::Index part = 1; part < parts; ++part) {
    others.push_back(std::async(kThreadIfThereIsOne, compute_part, part));
  }
  compute_part(0);
  for (std::future<void>& other : others) other.get();
}

}  // namespace inverse_dynamics_solver
