// SPDX-License-Identifier: Apache-2.0

/// @file
/// A benchmark that calls something once for each state, and reports the time of one call.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "states.hpp"

namespace inverse_dynamics_benchmarks {

/// Reports the time of one state: the least of all repetitions is what the machine can do.
inline void asTimePerState(benchmark::internal::Benchmark* benchmark) {
  benchmark->ComputeStatistics(
      "min", [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); });
}

/// `call(k)` for each of kStates states.
template <typename Call>
void registerOverStates(const std::string& name, Call call) {
  asTimePerState(benchmark::RegisterBenchmark(name.c_str(), [call](benchmark::State& state) {
    Eigen::Index k = 0;
    for (auto _ : state) {
      call(k);
      k = (k + 1) % kStates;
    }
  }));
}

/// `call()` for `states` states at once; the counter `states` says how many.
template <typename Call>
benchmark::internal::Benchmark* registerBatch(const std::string& name, Eigen::Index states,
                                              Call call) {
  benchmark::internal::Benchmark* const batch =
      benchmark::RegisterBenchmark(name.c_str(), [call, states](benchmark::State& state) {
        for (auto _ : state) call();
        state.counters["states"] = static_cast<double>(states);
      });
  asTimePerState(batch);
  return batch;
}

}  // namespace inverse_dynamics_benchmarks
