// SPDX-License-Identifier: Apache-2.0

/// @file
/// The finest clock there is: the processor's counter, or the system's clock where that isn't
/// known.
#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

#ifdef __x86_64__
#include <x86intrin.h>
#endif

namespace inverse_dynamics_benchmarks {

/// Counts up at a constant rate. Waits for the instructions before it.
inline std::uint64_t ticks() {
#ifdef __x86_64__
  _mm_lfence();
  return __rdtsc();
#else
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch() /
                                    std::chrono::nanoseconds(1));
#endif
}

/// Nanoseconds of one tick; takes 50 ms.
inline double nanosecondsPerTick() {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const std::uint64_t first = ticks();
  while (Clock::now() - begin < std::chrono::milliseconds(50)) continue;
  const std::uint64_t last = ticks();
  const std::chrono::duration<double, std::nano> time = Clock::now() - begin;
  return time.count() / static_cast<double>(last - first);
}

}  // namespace inverse_dynamics_benchmarks
