// SPDX-License-Identifier: Apache-2.0

/// @file
/// A quantile of numbers: 0.5 for the median.

#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// @param values  at least one.
/// @param share   0 to 1.
inline double quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
