// SPDX-License-Identifier: Apache-2.0

// FastModel::forwardDynamics().

#include <gtest/gtest.h>

#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

VectorX<double> accelerationsOf(const Chain& chain, const VectorX<double>& q,
                                const VectorX<double>& qd, const VectorX<double>& tau) {
  const FastModel fast(Model(chain), FastModel::instructionSets().back());
  VectorX<double> qdd(chain.jointCount());
  fast.forwardDynamics(q.data(), qd.data(), tau.data(), qdd.data());
  return qdd;
}

// Each state of a chain that isn't too long for FastModel.
template <class Check>
void forEachFastState(const Check& check) {
  forEachState([&](const Chain& chain, const State<double>& state) {
    if (chain.jointCount() <= FastModel::kMaxJoints) check(chain, state);
  });
}

VectorX<double> torquesThatCause(const Chain& chain, const State<double>& state) {
  VectorX<double> tau(chain.jointCount());
  torques(chain, state.q, state.qd, state.qdd, tau);
  return tau;
}

// A free particle in polar coordinates: m r^2 phi'' = -2 m r r' phi', r'' = r phi'^2. The table
// itself has no inertia, nor needs any as long as r isn't zero.
TEST(ForwardDynamics, OfATurntableWithoutTorquesIsAStraightLine) {
  const Eigen::Vector2d q(0.3, 0.4);
  const Eigen::Vector2d qd(2, -0.7);
  const VectorX<double> qdd = accelerationsOf(turntable(3), q, qd, VectorX<double>::Zero(2));
  EXPECT_TRUE(agree(qdd, Eigen::Vector2d(-2 * -0.7 * 2 / 0.4, 0.4 * 2 * 2), 10, kByHand));
}

// The torques of the accelerations found are those asked for: no condition of H in this way round.
TEST(ForwardDynamics, IsInvertedByInverseDynamics) {
  forEachFastState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> tau = 10 * state.qdd;
    const State<double> moved{state.q, state.qd, accelerationsOf(chain, state.q, state.qd, tau)};
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> H(n, n);
    VectorX<double> c(n);
    VectorX<double> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);
    const double terms = largest(H.cwiseAbs() * moved.qdd.cwiseAbs() + c.cwiseAbs() + g.cwiseAbs());
    EXPECT_TRUE(agree(torquesThatCause(chain, moved), tau, terms, 4 * rounding(chain)));
  });
}

TEST(ForwardDynamics, MayOverwriteAnInput) {
  const Chain chain = randomChain(5);
  const State<double> state = randomState(chain, 3);
  VectorX<double> tau = state.qdd;
  const VectorX<double> expected = accelerationsOf(chain, state.q, state.qd, tau);
  const FastModel fast(Model(chain), FastModel::instructionSets().back());
  fast.forwardDynamics(state.q.data(), state.qd.data(), tau.data(), tau.data());
  EXPECT_EQ(tau, expected);
}

}  // namespace
}  // namespace chain_dynamics
