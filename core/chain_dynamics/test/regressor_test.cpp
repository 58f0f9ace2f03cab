// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/regressor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

MatrixX<double> regressorOf(const Chain& chain, const State<double>& state) {
  MatrixX<double> Y(chain.jointCount(), 10 * chain.jointCount());
  regressor(chain, state.q, state.qd, state.qdd, Y);
  return Y;
}

VectorX<double> rotorInertia(const Chain& chain) {
  VectorX<double> rotor(chain.jointCount());
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    rotor[i] = chain.joints()[static_cast<std::size_t>(i)].rotor_inertia;
  }
  return rotor;
}

TEST(Parameters, StandTenPerLinkInTheOrderOfTheChain) {
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  VectorX<double> expected(20);
  expected << 1.5, 1.5 * 0.6, 0, 0, 0, 0, 0, 1.5 * 0.6 * 0.6, 0, 1.5 * 0.6 * 0.6,  //
      0.8, 0.8 * 0.4, 0, 0, 0, 0, 0, 0.8 * 0.4 * 0.4, 0, 0.8 * 0.4 * 0.4;
  EXPECT_TRUE(agree(parameters(chain), expected, 10, kByHand));
}

// The regressor knows the motion only: other parameters, the same matrix. These have all ten
// numbers of any sign, so that no column can hide behind a sum that bodies always fulfil.
TEST(Regressor, HoldsForParametersNoBodyHas) {
  forEachState([](const Chain& chain, const State<double>& state) {
    Random random(5);
    std::vector<LinkParameters> links;
    for (std::size_t i = 0; i < chain.links().size(); ++i) {
      links.push_back(randomIdentifiedLink(random));
      links.back().mass = std::abs(links.back().mass);
    }
    const Chain other("other", chain.joints(), links, chain.gravity());
    const MatrixX<double> Y = regressorOf(chain, state);
    EXPECT_EQ(Y, regressorOf(other, state));

    const VectorX<double> p = parameters(other);
    VectorX<double> tau(chain.jointCount());
    torques(other, state.q, state.qd, state.qdd, tau);
    tau -= rotorInertia(chain).cwiseProduct(state.qdd);
    EXPECT_TRUE(agree(Y * p, tau, largest(Y.cwiseAbs() * p.cwiseAbs()), rounding(chain)));
  });
}

TEST(Regressor, HasZerosForLinksBeforeTheJoint) {
  const Chain chain = randomChain(6);
  const MatrixX<double> Y = regressorOf(chain, randomState(chain, 0));
  for (Eigen::Index j = 1; j < chain.jointCount(); ++j) {
    EXPECT_EQ(Y.row(j).head(10 * j).norm(), 0) << "row " << j;
  }
}

}  // namespace
}  // namespace chain_dynamics
