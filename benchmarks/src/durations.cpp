// SPDX-License-Identifier: Apache-2.0
#include "durations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace inverse_dynamics_benchmarks {

std::uint64_t Durations::quantile(double part) const {
  if (count_ == 0) throw std::logic_error("no durations");
  const auto rank = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (std::uint64_t duration = 0; duration < kShort; ++duration) {
    seen += counts_[duration];
    if (seen >= rank) return duration;
  }
  std::vector<std::uint64_t> sorted = long_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[rank - seen - 1];
}

std::uint64_t Durations::sum() const {
  std::uint64_t sum = std::accumulate(long_.begin(), long_.end(), std::uint64_t{0});
  for (std::uint64_t duration = 0; duration < kShort; ++duration) {
    sum += duration * counts_[duration];
  }
  return sum;
}

}  // namespace inverse_dynamics_benchmarks
