// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part four: what a control loop can't have. Include conformance_tests.hpp, not
/// this.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <limits>
#include <vector>

#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/conformance/without_system_calls.hpp"

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace inverse_dynamics_solver::conformance {

/// Calls every method that writes into memory of the caller.
class CallsOfALoop {
 public:
  explicit CallsOfALoop(const InverseDynamicsSolver& solver) : methods_(methodsOf(solver)) {
    for (const Method& method : methods_) outputs_.push_back(method.shapes.memory());
  }

  void operator()(const State& x) {
    for (std::size_t i = 0; i < methods_.size(); ++i) methods_[i].into_memory(x, outputs_[i]);
  }

 private:
  std::vector<Method> methods_;
  std::vector<Matrices> outputs_;
};

/// The very first calls count too: the solver is a fresh one.
TEST_P(SolverConformance, CallsIntoMemoryOfTheCallerMakeNoSystemCall) {
  const SystemCalls proof = runWithoutSystemCalls([] { getppid(); });
  if (proof == SystemCalls::kNotKnown) GTEST_SKIP() << "system calls can't be forbidden here";
  ASSERT_EQ(proof, SystemCalls::kMade) << "a system call isn't seen";

  const std::vector<State> states = randomStates(kStates);
  CallsOfALoop calls(*solver_);
  const SystemCalls found = runWithoutSystemCalls([&] {
    for (const State& x : states) calls(x);
  });
  EXPECT_NE(found, SystemCalls::kMade) << "a system call is made: strace names it";
  EXPECT_NE(found, SystemCalls::kFailed) << "a call threw or crashed";
}

#ifdef __SSE2__

/// Flags of the processor that say: an operand, or a result, was too small for all its digits.
constexpr unsigned kDenormalFlags = 0x0002U | 0x0010U;

template <typename Code>
unsigned denormalFlagsOf(const Code& code) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before & ~_MM_EXCEPT_MASK);
  code();
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  return after & kDenormalFlags;
}

#endif

/// Some processors take a hundred times as long for such numbers. At rest, and between 1e-100 and
/// 1e9 rad/s, none arises; a filter that decays beyond that must be cut off by its owner.
TEST_P(SolverConformance, NoDenormalNumberArises) {
#ifdef __SSE2__
  volatile double smallest = std::numeric_limits<double>::min();
  ASSERT_NE(denormalFlagsOf([&] { smallest = smallest / 3.0; }), 0U) << "the flags aren't set";

  CallsOfALoop calls(*solver_);
  for (const State& x : randomStates(kStates)) {
    for (const double position : {0.0, 1.0}) {
      for (const double motion : {0.0, 1e-100, 1e-9, 1.0, 1e3, 1e9}) {
        const State scaled = {position * x.q, motion * x.qd, motion * x.qdd};
        EXPECT_EQ(denormalFlagsOf([&] { calls(scaled); }), 0U) << toString(scaled);
      }
    }
  }
#else
  GTEST_SKIP() << "this processor's flags aren't read";
#endif
}

}  // namespace inverse_dynamics_solver::conformance
