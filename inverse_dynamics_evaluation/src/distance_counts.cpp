// SPDX-License-Identifier: Apache-2.0

#include "distance_counts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr std::size_t kMostDistances = 65536;  // different distances, and distances that wait

}  // namespace

void DistanceCounts::add(std::int64_t distance) {
  waiting_.push_back(distance);
  if (waiting_.size() == kMostDistances) {
    merge();
  }
}

// Counts those that wait.
void DistanceCounts::merge() const {
  std::sort(waiting_.begin(), waiting_.end());
  std::vector<Count> merged;
  merged.reserve(counts_.size());
  const auto put = [&](const Count& next) {
    if (!merged.empty() && merged.back().first == next.first) {
      merged.back().second += next.second;
    } else {
      merged.push_back(next);
    }
  };
  auto counted = counts_.begin();
  for (const std::int64_t distance : waiting_) {
    const std::int64_t key = distance >> shift_;
    for (; counted != counts_.end() && counted->first <= key; ++counted) {
      put(*counted);
    }
    put({key, 1});
  }
  std::for_each(counted, counts_.end(), put);
  waiting_.clear();
  while (merged.size() > kMostDistances) {
    ++shift_;
    const std::vector<Count> finer = std::move(merged);
    merged.clear();
    for (const Count& count : finer) {
      put({count.first >> 1, count.second});
    }
  }
  counts_ = std::move(merged);
}

template <class Visit>
void DistanceCounts::forEach(double limit, Visit visit) const {
  merge();
  const double step = std::ldexp(1.0, shift_);
  for (const auto& [key, count] : counts_) {
    const double middle = static_cast<double>(key) * step + 0.5 * (step - 1.0);
    if (std::abs(middle) <= limit) {
      visit(middle, count);
    }
  }
}

std::int64_t DistanceCounts::count(double limit) const {
  std::int64_t all = 0;
  forEach(limit, [&](double, std::int64_t count) { all += count; });
  return all;
}

double DistanceCounts::mean(double limit) const {
  double sum = 0.0;
  double all = 0.0;
  forEach(limit, [&](double distance, std::int64_t count) {
    sum += distance * static_cast<double>(count);
    all += static_cast<double>(count);
  });
  return all > 0 ? sum / all : 0.0;
}

double DistanceCounts::deviation(double limit) const {
  const double middle = mean(limit);
  double squares = 0.0;
  double all = 0.0;
  forEach(limit, [&](double distance, std::int64_t count) {
    squares += std::pow(distance - middle, 2) * static_cast<double>(count);
    all += static_cast<double>(count);
  });
  return all > 0 ? std::sqrt(squares / all) : 0.0;
}

double DistanceCounts::quantile(double share, double limit) const {
  const auto rank = static_cast<std::int64_t>(
      share * static_cast<double>(std::max<std::int64_t>(count(limit), 1) - 1));
  double found = 0.0;
  std::int64_t before = 0;
  forEach(limit, [&](double distance, std::int64_t count) {
    found = before <= rank ? distance : found;
    before += count;
  });
  return found;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
