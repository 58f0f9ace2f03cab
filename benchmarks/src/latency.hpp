// SPDX-License-Identifier: Apache-2.0

/// @file
/// How long each of many calls takes, and what of it the system adds.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "durations.hpp"
#include "states.hpp"
#include "ticks.hpp"

namespace inverse_dynamics_benchmarks {

/// What millions of calls took [ns].
struct Latency {
  std::string name;  ///< ROBOT/QUANTITY/LIBRARY
  long calls;
  double p50, p99, p9999, max;

  /// Each state is computed thousands of times, and nothing but the system makes these differ. The
  /// least of them is what the state takes; this is the greatest of these.
  double slowest_state;

  /// Calls that took more than twice the least of their state and kInterruption, per second of
  /// calls.
  double interruptions_per_second;

  /// What the system says of this thread in the meantime.
  long context_switches, page_faults;
};

constexpr double kInterruption = 1000.0;  // ns

/// Calls with state 0, 1, ..., kStates - 1 again and again, one by one, and remembers the least
/// time of each state.
template <typename Call>
class TimedCalls {
 public:
  explicit TimedCalls(Call call) : call_(call) {
    least_.fill(std::numeric_limits<std::uint64_t>::max());
  }

  /// Ticks that call i takes.
  std::uint64_t operator()(long i) {
    const std::uint64_t begin = ticks();
    call_(static_cast<Eigen::Index>(i % kStates));
    const std::uint64_t duration = ticks() - begin;
    std::uint64_t& least = least_[static_cast<std::size_t>(i % kStates)];
    least = std::min(least, duration);
    return duration;
  }

  std::uint64_t least(long i) const { return least_[static_cast<std::size_t>(i % kStates)]; }
  std::uint64_t slowestState() const { return *std::max_element(least_.begin(), least_.end()); }

 private:
  Call call_;
  std::array<std::uint64_t, kStates> least_;
};

/// Times `call(k)` for states k, `calls` times in all. tick: nanoseconds of a tick.
template <typename Call>
Latency measureLatency(const std::string& name, long calls, double tick, Call call) {
  TimedCalls<Call> timed(call);
  constexpr long kWarmUp = 16 * kStates;
  for (long i = 0; i < kWarmUp; ++i) timed(i);

  Durations durations;
  const auto interruption = static_cast<std::uint64_t>(kInterruption / tick);
  long interruptions = 0;
  rusage before{}, after{};
  getrusage(RUSAGE_THREAD, &before);
  for (long i = 0; i < calls; ++i) {
    const std::uint64_t duration = timed(i);
    if (duration > 2 * timed.least(i) + interruption) ++interruptions;
    durations.add(duration);
  }
  getrusage(RUSAGE_THREAD, &after);

  const auto time = [&](std::uint64_t duration) { return static_cast<double>(duration) * tick; };
  return {name,
          calls,
          time(durations.quantile(0.50)),
          time(durations.quantile(0.99)),
          time(durations.quantile(0.9999)),
          time(durations.quantile(1.0)),
          time(timed.slowestState()),
          static_cast<double>(interruptions) / (1e-9 * time(durations.sum())),
          after.ru_nvcsw - before.ru_nvcsw + after.ru_nivcsw - before.ru_nivcsw,
          after.ru_minflt - before.ru_minflt + after.ru_majflt - before.ru_majflt};
}

}  // namespace inverse_dynamics_benchmarks
