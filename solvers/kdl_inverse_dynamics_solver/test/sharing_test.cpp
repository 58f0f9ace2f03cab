// SPDX-License-Identifier: Apache-2.0
/// @file
/// Why each thread borrows a workspace: what happens to KDL where threads share one.
///
/// Their numbers change, in any build; ThreadSanitizer reports the race. (Debian's KDL isn't
/// compiled with it, but moves memory by a function that it watches.)

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>
#include <string>
#include <thread>

#include "chain_dynamics/chain.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "kdl_chain.hpp"
#include "kdl_workspace.hpp"

namespace kdl_inverse_dynamics_solver::sharing_test {

/// Calls until threads must have met: one is interrupted within a call every few milliseconds.
constexpr int kMostCalls = 10'000'000;

chain_dynamics::Chain ur10() {
  using namespace inverse_dynamics_solver;  // NOLINT(google-build-using-namespace)
  const std::string urdf = conformance::textOf(conformance::robotsFile("urdf/ur10.urdf"));
  return chainFromDescription(readConfiguration({}, "", urdf));
}

KDL::JntArray state(double number) {
  KDL::JntArray result(6);
  result.data.setConstant(number);
  return result;
}

using Compute = std::function<KDL::JntArray(const KDL::JntArray&)>;

/// Whether two threads, each at a state of its own, ever get other numbers than one alone.
bool threadsSpoilNumbers(const Compute& compute) {
  const KDL::JntArray states[] = {state(0.3), state(-1.2)};
  const KDL::JntArray alone[] = {compute(states[0]), compute(states[1])};
  std::atomic<bool> spoilt{false};
  const auto work = [&](int i) {
    for (int k = 0; k < kMostCalls && !spoilt; ++k) {
      if (compute(states[i]).data != alone[i].data) spoilt = true;
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  return spoilt;
}

void expectRace(const Compute& compute) {
#ifdef __SANITIZE_THREAD__
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto run = [&compute] {
    threadsSpoilNumbers(compute);
    std::exit(0);  // the sanitizer makes it 66 if it has reported anything
  };
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(66), "ThreadSanitizer: data race");
#else
  EXPECT_TRUE(threadsSpoilNumbers(compute));
#endif
}

TEST(ThreadsThatShare, KdlsNewtonEulerSolverRace) {
  const KDL::Chain chain = toKdl(ur10());
  KDL::ChainIdSolver_RNE solver(chain, KDL::Vector(0, 0, -9.81));
  expectRace([&](const KDL::JntArray& q) {
    KDL::JntArray tau(6);
    solver.CartToJnt(q, q, q, KDL::Wrenches(6, KDL::Wrench::Zero()), tau);
    return tau;
  });
}

TEST(ThreadsThatShare, KdlsDynamicParametersRace) {
  const KDL::Chain chain = toKdl(ur10());
  KDL::ChainDynParam solver(chain, KDL::Vector(0, 0, -9.81));
  expectRace([&](const KDL::JntArray& q) {
    KDL::JntArray g(6);
    solver.JntToGravity(q, g);
    return g;
  });
}

TEST(ThreadsThatShare, AWorkspaceRace) {
  KdlWorkspace workspace(toKdl(ur10()), KDL::Vector(0, 0, -9.81));
  expectRace([&](const KDL::JntArray& q) {
    KDL::JntArray tau(6);
    workspace.torques(q.data, q.data, q.data, tau.data);
    return tau;
  });
}

}  // namespace kdl_inverse_dynamics_solver::sharing_test
