// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part two: sizes, errors, forms of the methods, memory, threads, NaN. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chain_dynamics/chain.hpp>
#include <cstddef>
#include <functional>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/friction_memory.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"
#include "inverse_dynamics_solver/torque_deviation.hpp"

namespace inverse_dynamics_solver::conformance {

TEST_P(SolverConformance, JointNamesAreDistinctAndCounted) {
  const std::vector<std::string>& names = solver_->jointNames();
  EXPECT_GT(solver_->jointCount(), 0);
  EXPECT_EQ(static_cast<Eigen::Index>(names.size()), solver_->jointCount());
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).count(""), 0U);
}

TEST_P(SolverConformance, ContinuousJointsAreTheSameAfterATurn) {
  const std::vector<chain_dynamics::JointType>& types = solver_->jointTypes();
  ASSERT_EQ(static_cast<Eigen::Index>(types.size()), solver_->jointCount());
  const State x = randomState();
  State turned = x;
  chain_dynamics::unwrap(types, Eigen::VectorXd::Constant(x.q.size(), 10.0), turned.q);
  const Eigen::VectorXd tau = solver_->getTorques(x.q, x.qd, x.qdd);
  const Eigen::VectorXd again = solver_->getTorques(turned.q, turned.qd, turned.qdd);
  EXPECT_TRUE(near(again, tau, kRounding, sizeOf(tau))) << toString(x);
}

TEST_P(SolverConformance, ResultsHaveTheSizesOfTheRobotAndAreFinite) {
  const Eigen::Index n = solver_->jointCount();
  const State x = randomState();
  EXPECT_EQ(solver_->getInertiaMatrix(x.q).rows(), n);
  EXPECT_EQ(solver_->getInertiaMatrix(x.q).cols(), n);
  EXPECT_EQ(solver_->getCoriolisVector(x.q, x.qd).size(), n);
  EXPECT_EQ(solver_->getFrictionVector(x.q, x.qd).size(), n);
  EXPECT_EQ(solver_->getGravityVector(x.q).size(), n);
  EXPECT_EQ(solver_->getTorques(x.q, x.qd, x.qdd).size(), n);
  for (const Method& method : methodsOf(*solver_)) {
    EXPECT_TRUE(flat(method.by_value(x)).allFinite()) << method.name << toString(x);
  }
}

TEST_P(SolverConformance, UninitializedSolverRefusesEveryMethod) {
  const auto solver = make();
  const State x = randomState();
  EXPECT_FALSE(solver->isInitialized());
  for (const Method& method : methodsOf(*solver, x.q.size())) {
    const std::string error = errorOf<UninitializedException>([&] { method.by_value(x); });
    EXPECT_TRUE(contains(error, {method.name, "initialize()"}));
  }
  errorOf<UninitializedException>([&] { solver->jointCount(); });
  errorOf<UninitializedException>([&] { solver->jointNames(); });
  errorOf<UninitializedException>([&] { solver->jointTypes(); });
  errorOf<UninitializedException>([&] { solver->inertiaIsPhysical(); });
  errorOf<UninitializedException>([&] { solver->getTorquesBatch(x.q, x.qd, x.qdd); });
}

TEST_P(SolverConformance, WrongSizeIsRefusedNamingArgumentExpectedAndGot) {
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::Index n = s.jointCount();
  const Eigen::VectorXd ok = Eigen::VectorXd::Zero(n);
  for (const Eigen::Index size : {Eigen::Index{0}, n - 1, n + 1}) {
    const Eigen::VectorXd no = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd out = ok, short_out = no;
    Eigen::MatrixXd H(n, n), short_H(n, size);
    const std::string expected = "expected " + std::to_string(n);
    const auto refuses = [&](const std::string& method, const std::string& argument,
                             const std::function<void()>& call) {
      const std::string error = errorOf<SizeMismatchException>(call);
      EXPECT_TRUE(contains(error, {method, "argument " + argument + ":", expected,
                                   std::to_string(size), s.jointNames().front()}));
    };
    refuses("getInertiaMatrix", "q", [&] { s.getInertiaMatrix(no); });
    refuses("getInertiaMatrix", "H", [&] { s.getInertiaMatrix(ok, short_H); });
    refuses("getCoriolisVector", "q", [&] { s.getCoriolisVector(no, ok); });
    refuses("getCoriolisVector", "qd", [&] { s.getCoriolisVector(ok, no); });
    refuses("getCoriolisVector", "c", [&] { s.getCoriolisVector(ok, ok, short_out); });
    refuses("getFrictionVector", "qd", [&] { return s.getFrictionVector(no); });
    refuses("getFrictionVector", "qd", [&] { return s.getFrictionVector(ok, no); });
    refuses("getFrictionVector", "f", [&] { s.getFrictionVector(ok, ok, short_out); });
    // (no positions are fine where friction doesn't depend on them)
    if (size > 0 || frictionDependsOnPosition(s)) {
      refuses("getFrictionVector", "q", [&] { return s.getFrictionVector(no, ok); });
    }
    refuses("getGravityVector", "q", [&] { s.getGravityVector(no); });
    refuses("getGravityVector", "g", [&] { s.getGravityVector(ok, short_out); });
    refuses("getDynamicComponents", "q", [&] { s.getDynamicComponents(no, ok); });
    refuses("getDynamicComponents", "qd", [&] { s.getDynamicParameters(ok, no); });
    refuses("getDynamicComponents", "g",
            [&] { s.getDynamicComponents(ok, ok, H, out, short_out); });
    refuses("getTorques", "q", [&] { s.getTorques(no, ok, ok); });
    refuses("getTorques", "qd", [&] { s.getTorques(ok, no, ok); });
    refuses("getTorques", "qdd", [&] { s.getTorques(ok, ok, no); });
    refuses("getTorques", "tau", [&] { s.getTorques(ok, ok, ok, short_out); });
    refuses("getTorquesBatch", "qd", [&] { s.getTorquesBatch(ok, no, ok); });
  }
}

TEST_P(SolverConformance, ResultsByValueEqualResultsInMemoryOfTheCaller) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    // A stale entry would show: the memory is filled with NaN before each call.
    for (const Method& method : methodsOf(s)) {
      Matrices out = method.shapes.memory(std::numeric_limits<double>::quiet_NaN());
      method.into_memory(x, out);
      EXPECT_TRUE(identical(flat(method.by_value(x)), flat(out))) << method.name;
    }
  }
}

TEST_P(SolverConformance, CallsIntoMemoryOfTheCallerDoNotAllocate) {
  if (!kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted in this build";
  const InverseDynamicsSolver& s = *solver_;
  const State x = randomState();
  Eigen::VectorXd tau(s.jointCount());

  // The counter counts. Clang leaves out a pair of malloc and free, or new and delete, whose memory
  // isn't used; but no call of these functions by their names.
  AllocationGuard proof;
  ::operator delete(::operator new(1));
  ASSERT_GT(proof.count(), 0) << "the allocation guard doesn't see allocations";

  const auto allocations = [](const std::function<void()>& call) {
    AllocationGuard guard;
    call();
    return guard.count();
  };
  for (const Method& method : methodsOf(s)) {
    Matrices out = method.shapes.memory();
    EXPECT_EQ(allocations([&] { method.into_memory(x, out); }), 0) << method.name;
  }
  if (const auto* motors = dynamic_cast<const MotorCurrents*>(&s)) {
    EXPECT_EQ(allocations([&] { motors->getCurrents(x.q, x.qd, x.qdd, tau); }), 0);
  }
  const auto* const band = dynamic_cast<const TorqueDeviation*>(&s);
  if (band != nullptr && band->hasTorqueDeviation()) {
    EXPECT_EQ(allocations([&] { band->getTorqueDeviation(tau); }), 0);
  }
  chain_dynamics::FrictionState friction = frictionState(s);
  EXPECT_EQ(allocations([&] {
              friction.reset();
              friction.move(x.q);
              friction.addTo(x.qd, tau);
            }),
            0);
}

TEST_P(SolverConformance, ManyThreadsGetTheNumbersOfOne) {
  constexpr int kThreads = 8;
  constexpr int kRounds = 20;
  const std::vector<State> states = randomStates(32);
  const std::vector<Method> all = methodsOf(*solver_);

  // What one thread computes.
  std::vector<Eigen::VectorXd> expected;
  for (const State& x : states) {
    for (const Method& method : all) expected.push_back(flat(method.by_value(x)));
  }

  // Each thread begins at another state, so that different states are computed at the same time.
  std::atomic<int> waiting{kThreads};
  std::atomic<long> different{0};
  const auto work = [&](std::size_t thread) {
    for (--waiting; waiting > 0;) std::this_thread::yield();
    for (std::size_t i = 0; i < states.size() * kRounds; ++i) {
      const std::size_t k = (i + 4 * thread) % states.size();
      for (std::size_t j = 0; j < all.size(); ++j) {
        const Eigen::VectorXd value = flat(all[j].by_value(states[k]));
        if (!identical(value, expected[k * all.size() + j])) ++different;
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kThreads; ++i) threads.emplace_back(work, i);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0) << "results depend on what other threads do";
}

/// For each input number: the entries that change with it must become NaN with it.
TEST_P(SolverConformance, NanGoesToEveryEntryThatDependsOnIt) {
  const InverseDynamicsSolver& s = *solver_;
  for (const Method& method : methodsOf(s)) {
    for (Eigen::VectorXd State::*argument : {&State::q, &State::qd, &State::qdd}) {
      for (Eigen::Index j = 0; j < s.jointCount(); ++j) {
        using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;
        Flags depends, is_nan;
        for (const State& x : randomStates(4)) {
          const Eigen::VectorXd value = flat(method.by_value(x));
          State changed = x, spoilt = x;
          (changed.*argument)[j] += 0.7;
          (spoilt.*argument)[j] = std::numeric_limits<double>::quiet_NaN();
          const Eigen::VectorXd difference = flat(method.by_value(changed)) - value;
          const Flags moved = difference.array().abs() > 1e-9 * sizeOf(value);
          const Flags lost = flat(method.by_value(spoilt)).array().isNaN();
          depends = depends.size() == 0 ? moved : Flags(depends || moved);
          is_nan = is_nan.size() == 0 ? lost : Flags(is_nan && lost);
        }
        EXPECT_TRUE((!depends || is_nan).all()) << method.name << ": entries depend on number " << j
                                                << " of an input, and hide that it is NaN";
      }
    }
  }
}

}  // namespace inverse_dynamics_solver::conformance
