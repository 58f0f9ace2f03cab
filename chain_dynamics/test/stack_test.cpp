// SPDX-License-Identifier: Apache-2.0

// How much stack a call needs: what docs/real_time.md states, for the longest chains that need no
// other memory. A thread on a painted stack makes the calls; what isn't paint any more was used.

#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/forward_dynamics.hpp"
#include "chain_dynamics/parameter_sets.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"
#include "chain_dynamics/torque_derivatives.hpp"
#include "example_models.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Stated in scratch.hpp, fast_model.hpp and docs/real_time.md.
constexpr std::size_t kKiB = 1024;
constexpr std::size_t kPlainBound = 24 * kKiB;
constexpr std::size_t kOneStateBound = 48 * kKiB;
constexpr std::size_t kManyStatesBound = 112 * kKiB;

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

using Calls = std::map<std::string, std::function<void()>>;

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

// Sanitizers, coverage and profiles need stack of their own; only some of them define a macro.
constexpr bool kMeasurable = !CHAIN_DYNAMICS_INSTRUMENTED;
const char* const kWhyNot = "instrumented code needs stack of its own";

class Stack : public ::testing::TestWithParam<std::string> {};

TEST_P(Stack, OfOneStateIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  for (const Model& model : largest()) {
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 1);
    const Index n = x.q.size();
    const double* const q = x.q.data();
    const double* const qd = x.qd.data();
    const double* const qdd = x.qdd.data();
    MatrixXd H(n, n), by_q(n, n), by_qd(n, n), J(6, n), Y(n, 10 * n);
    VectorXd c(n), g(n);
    double R[9], p[3];
    expectWithin(
        kOneStateBound, GetParam(),
        {{"torques", [&] { fast.torques(q, qd, qdd, c.data()); }},
         {"H", [&] { fast.inertiaMatrix(q, H.data(), n); }},
         {"c", [&] { fast.coriolisVector(q, qd, c.data()); }},
         {"g", [&] { fast.gravityVector(q, g.data()); }},
         {"f", [&] { fast.frictionVector(q, qd, c.data()); }},
         {"components", [&] { fast.dynamicComponents(q, qd, H.data(), n, c.data(), g.data()); }},
         {"forward dynamics", [&] { fast.forwardDynamics(q, qd, qdd, c.data()); }},
         {"regressor", [&] { fast.regressor(q, qd, qdd, Y.data(), n); }},
         {"C", [&] { fast.coriolisMatrix(q, qd, H.data(), n); }},
         {"tip", [&] { fast.tipPose(q, R, p); }},
         {"J", [&] { fast.tipJacobian(q, J.data(), 6); }},
         {"dJ", [&] { fast.tipJacobianDerivative(q, qd, J.data(), 6); }},
         {"derivatives",
          [&] { fast.torqueDerivatives(q, qd, qdd, by_q.data(), by_qd.data(), H.data(), n); }}});
  }
}

TEST_P(Stack, OfManyStatesIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  for (const Model& model : largest()) {
    const FastModel fast(model, GetParam());
    const Index n = model.chain.jointCount();
    constexpr Index kStates = 20;
    const MatrixXd q = MatrixXd::Constant(n, kStates, 0.3);
    MatrixXd H(n, n * kStates), Y(n, 10 * n * kStates), c = q, g = q;
    MatrixXd R(3, 3 * kStates), p(3, kStates), J(6, n * kStates);
    RegressorGram gram(n, 1);
    expectWithin(kManyStatesBound, GetParam(),
                 {{"torques", [&] { fast.torquesBatch(q, q, q, c); }},
                  {"H", [&] { fast.inertiaMatrixBatch(q, H); }},
                  {"c", [&] { fast.coriolisVectorBatch(q, q, c); }},
                  {"g", [&] { fast.gravityVectorBatch(q, g); }},
                  {"f", [&] { fast.frictionVectorBatch(q, q, c); }},
                  {"components", [&] { fast.dynamicComponentsBatch(q, q, H, c, g); }},
                  {"forward dynamics", [&] { fast.forwardDynamicsBatch(q, q, q, c); }},
                  {"regressor", [&] { fast.regressorBatch(q, q, q, Y); }},
                  {"C", [&] { fast.coriolisMatrixBatch(q, q, H); }},
                  {"tip", [&] { fast.tipPoseBatch(q, R, p); }},
                  {"J", [&] { fast.tipJacobianBatch(q, J); }},
                  {"dJ", [&] { fast.tipJacobianDerivativeBatch(q, q, J); }},
                  {"Gram matrices", [&] {
                     fast.addToGram({q, q, q, q, {q}}, gram);
                   }}});
  }
}

// Up to sixteen joints: derivatives of longer chains are those of one state.
TEST_P(Stack, OfDerivativesOfManyStatesIsBounded) {
  if (!kMeasurable) GTEST_SKIP() << kWhyNot;
  constexpr Index kJoints = 16;
  constexpr Index kStates = 20;
  const Chain chain = randomChain(kJoints);
  for (const Model& model : {Model(chain), identified(chain, true, true, 3),
                             withChangingSteps(identified(chain, true, false, 3), 5)}) {
    const FastModel fast(model, GetParam());
    const MatrixXd q = MatrixXd::Constant(kJoints, kStates, 0.3);
    MatrixXd by_q(kJoints, kJoints * kStates), by_qd = by_q, H = by_q;
    expectWithin(kManyStatesBound, GetParam(),
                 {{"derivatives", [&] { fast.torqueDerivativesBatch(q, q, q, by_q, by_qd, H); }},
                  {"C", [&] { fast.coriolisMatrixBatch(q, q, H); }}});
  }
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
  const std::vector<std::vector<LinkParameters>> rows(kStackJoints, chain.links());
  const ParameterSets sets{rows, rows[0]};
  Model model(chain);
  model.friction.resize(kStackJoints, SmoothCoulomb{1, 2, 0.1, 0.01, 0.3, 0.1, 0.5, 0.2});
  const State<double> x = randomState(chain, 1);
  const VectorXd &q = x.q, &qd = x.qd, &qdd = x.qdd;
  const Index n = q.size();
  MatrixXd H(n, n), by_q(n, n), by_qd(n, n), J(6, n), Y(n, 10 * n);
  VectorXd c(n), g(n);
  expectWithin(
      kPlainBound, "plain",
      {{"torques", [&] { torques(chain, sets, q, qd, qdd, c); }},
       {"components", [&] { dynamicComponents(chain, sets, q, qd, H, c, g); }},
       {"C", [&] { coriolisMatrix(chain, sets, q, qd, H); }},
       {"tip", [&] { c.head(3) = tipPose(chain, q).p; }},
       {"J", [&] { tipJacobian(chain, q, J); }},
       {"dJ", [&] { tipJacobianDerivative(chain, q, qd, J); }},
       {"forward dynamics", [&] { forwardDynamics(chain, q, qd, qdd, c); }},
       {"regressor", [&] { regressor(chain, q, qd, qdd, Y); }},
       {"derivatives", [&] { torqueDerivatives(chain, sets, q, qd, qdd, by_q, by_qd, H); }},
       {"friction", [&] { frictionVector(model, q, qd, c); }},
       {"friction's derivatives", [&] { addFrictionDerivatives(model, q, qd, by_q, by_qd); }},
       {"energy", [&] { c[0] = kineticEnergy(chain, q, qd) + potentialEnergy(chain, q); }}});
}

}  // namespace
}  // namespace chain_dynamics
