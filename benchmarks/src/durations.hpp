// SPDX-License-Identifier: Apache-2.0

/// @file
/// Millions of durations, counted without disturbing what is measured.
#pragma once

#include <cstdint>
#include <vector>

namespace inverse_dynamics_benchmarks {

/// How often each duration occurred: exactly, in ticks.
class Durations {
 public:
  Durations() : counts_(kShort) { long_.reserve(1 << 16); }

  void add(std::uint64_t duration) {
    ++count_;
    if (duration < kShort) {
      ++counts_[duration];
    } else {
      long_.push_back(duration);
    }
  }

  /// The duration that a part of 0 to 1 of all doesn't exceed. Throws std::logic_error if there is
  /// none.
  std::uint64_t quantile(double part) const;

  std::uint64_t sum() const;

 private:
  static constexpr std::uint64_t kShort = 1 << 17;
  std::vector<std::uint32_t> counts_;
  std::vector<std::uint64_t> long_;
  std::uint64_t count_ = 0;
};

}  // namespace inverse_dynamics_benchmarks
