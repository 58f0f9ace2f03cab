// SPDX-License-Identifier: Apache-2.0

// How much stack a call needs: what docs/real_time.md states, for the longest chains that need no
// other memory. A thread on a painted stack makes the calls; what isn't paint any more was used.

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chain_dynamics/energy.hpp"
#include "quantities.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Stated in scratch.hpp, fast_model.hpp and docs/real_time.md.
constexpr std::size_t kKiB = 1024;
constexpr std::size_t kPlainBound = 24 * kKiB;  // twice as much of derivatives
constexpr std::size_t kOneStateBound = 48 * kKiB;
constexpr std::size_t kManyStatesBound = 112 * kKiB;
constexpr std::size_t kMechanismBound = 160 * kKiB;

void* callFunction(void* function) {
  (*static_cast<const std::function<void()>*>(function))();
  return nullptr;
}

/// Bytes from the end of a thread's stack to the farthest that a call touched; 0 with a failure
/// where there is no such thread.
std::size_t touched(const std::function<void()>& call) {
  constexpr std::size_t kSize = 512 * kKiB;
  constexpr unsigned char kPaint = 0xa5;
  static constexpr std::size_t kPage = 4096;
  std::vector<unsigned char> memory(kSize + kPage, kPaint);
  auto* const stack = memory.data() + kPage - reinterpret_cast<std::size_t>(memory.data()) % kPage;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  int error = pthread_attr_setstack(&attributes, stack, kSize);
  pthread_t thread{};
  auto* const argument = const_cast<void*>(static_cast<const void*>(&call));
  if (error == 0) error = pthread_create(&thread, &attributes, callFunction, argument);
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    ADD_FAILURE() << "no thread on a stack of its own: error " << error;
    return 0;
  }
  pthread_join(thread, nullptr);
  const auto* const farthest =
      std::find_if(stack, stack + kSize, [](unsigned char byte) { return byte != kPaint; });
  return static_cast<std::size_t>(stack + kSize - farthest);
}

/// Bytes of stack that a call needs, without those of its thread and of binding symbols.
std::size_t stackOf(const std::function<void()>& call) {
  call();
  return touched(call) - touched([] {});
}

void expectWithin(std::size_t bound, const std::string& who, const Calls& calls) {
  std::size_t most = 0;
  for (const auto& [name, call] : calls) {
    const std::size_t bytes = stackOf(call);
    EXPECT_LE(bytes, bound) << who << ": " << name;
    most = std::max(most, bytes);
  }
  EXPECT_GT(most, kKiB) << "nothing was measured";
}

/// Sliding and turning joints, and parameters for each row: what takes most memory.
std::vector<Model> largest() {
  const Chain chain = randomChain(FastModel::kMaxJoints);
  const Model rows = identified(chain, true, false, 3);
  return {Model(chain), identified(chain, true, true, 3), withChangingSteps(rows, 5)};
}

/// Two branches of the same joints, one after its coordinates, the other after multiples of them: nothing
/// that moves, but as much memory as a mechanism needs.
Model largestMechanism() {
  const Chain chain = randomChain(FastModel::kMaxJoints);
  Branch branch{"tip", chain, {}, {}, {}};
  for (Index j = 0; j < chain.jointCount(); ++j) {
    branch.S.push_back({j, j, 1});
    branch.s.push_back(0);
    branch.link.push_back(j);
  }
  Branch other = branch;
  for (Follow& entry : other.S) entry.factor = 0.5;
  Model model(Mechanism{chain, {branch, other}});
  model.friction.resize(chain.joints().size(), SmoothCoulomb{1, 2, 0.1, 0.01, 0.3, 0.1, 0.5, 0.2});
  return model;
}

// Sanitizers, coverage and profiles need stack of their own; only some of them define a macro.
constexpr bool kMeasurable = !CHAIN_DYNAMICS_INSTRUMENTED;
const char* const kWhyNot = "instrumented code needs stack of its own";

class Stack : public ::testing::TestWithParam<std::string> {};

TEST_P(Stack, OfOneStateIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  for (const Model& model : largest()) {
    const FastModel fast(model, GetParam());
    OneState state(randomState(model.chain, 1));
    expectWithin(kOneStateBound, GetParam(), state.callsOf(fast));
  }
}

TEST_P(Stack, OfManyStatesIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  for (const Model& model : largest()) {
    const FastModel fast(model, GetParam());
    const Index n = model.chain.jointCount();
    const State<double> x = randomState(model.chain, 1);
    ManyStates states(std::vector<State<double>>(20, x), n, layouts()[0]);
    Calls calls = states.callsOf(fast);
    calls.erase("derivatives");  // up to sixteen joints: those of longer chains are of one state
    const MatrixXd q = x.q.replicate(1, 20);
    RegressorGram gram(n, 1);
    calls["Gram matrices"] = [&] { fast.addToGram({q, q, q, q, {q}}, gram); };
    expectWithin(kManyStatesBound, GetParam(), calls);
  }
}

TEST_P(Stack, OfDerivativesOfManyStatesIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  constexpr Index kJoints = 16;
  const Chain chain = randomChain(kJoints);
  for (const Model& model : {Model(chain), identified(chain, true, true, 3),
                             withChangingSteps(identified(chain, true, false, 3), 5)}) {
    const FastModel fast(model, GetParam());
    const std::vector<State<double>> all(20, randomState(chain, 1));
    ManyStates states(all, kJoints, layouts()[0]);
    expectWithin(kManyStatesBound, GetParam(), states.callsOf(fast));
  }
}

TEST_P(Stack, OfMechanismsIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  const Model model = largestMechanism();
  const FastModel fast(model, GetParam());
  const State<double> x = randomState(model.chain, 1);
  OneState state(x);
  expectWithin(kMechanismBound, GetParam(), state.callsOf(fast));
  ManyStates states(std::vector<State<double>>(20, x), model.chain.jointCount(), layouts()[0]);
  Calls calls = states.callsOf(fast);
  calls.erase("derivatives");
  expectWithin(kMechanismBound, GetParam(), calls);
}

INSTANTIATE_TEST_SUITE_P(Every, Stack, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

TEST(StackOfPlainFunctions, IsBounded) {
#ifdef __OPTIMIZE__
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
#else
  GTEST_SKIP() << "without optimisation every temporary has a place of its own";
#endif
  const Chain chain = randomChain(kStackJoints);
  Model model(chain);
  model.row_parameters.assign(kStackJoints, chain.links());
  model.gravity_parameters = chain.links();
  model.friction.resize(kStackJoints, SmoothCoulomb{1, 2, 0.1, 0.01, 0.3, 0.1, 0.5, 0.2});
  const State<double> x = randomState(chain, 1);
  OneState state(x);
  Calls calls = state.callsOf(model);
  VectorXd qdd(chain.jointCount());
  calls["energy"] = [&] { qdd[0] = kineticEnergy(chain, x.q, x.qd) + potentialEnergy(chain, x.q); };
  Calls derivatives;
  for (const char* name : {"derivatives", "C", "dJ"}) derivatives.insert(calls.extract(name));
  expectWithin(kPlainBound, "plain", calls);
  expectWithin(2 * kPlainBound, "derivatives", derivatives);
}

}  // namespace
}  // namespace chain_dynamics
