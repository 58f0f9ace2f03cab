// SPDX-License-Identifier: Apache-2.0

/// @file
/// Distances of samples, counted: mean and median of any number of them in bounded memory.
///
///     DistanceCounts distances;
///     while (...) distances.add(8'000'123);   // ns
///     const double period = distances.quantile(0.5, limit);
///
/// Distances are whole numbers, of nanoseconds or of samples, so a long recording has few different
/// ones. Each is counted exactly while there are at most 65,536 of them; beyond that, neighbours are
/// counted together: twos, fours and so on. The result depends on the distances and their order
/// alone.

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

class DistanceCounts {
 public:
  void add(std::int64_t distance);

  /// How many are at most `limit` in size.
  std::int64_t count(double limit) const;

  /// Mean of those that are at most `limit` in size; 0 if there are none.
  double mean(double limit) const;

  /// Root mean square of their deviation from it.
  double deviation(double limit) const;

  /// The one that a share of them (0.5 for the median) doesn't exceed; 0 if there are none.
  double quantile(double share, double limit) const;

 private:
  using Count = std::pair<std::int64_t, std::int64_t>;  // distance >> shift_, and how many

  void merge() const;
  template <class Visit>
  void forEach(double limit, Visit visit) const;

  mutable std::vector<std::int64_t> waiting_;
  mutable std::vector<Count> counts_;  // by distance
  mutable int shift_ = 0;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
