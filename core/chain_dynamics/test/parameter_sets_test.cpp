// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/parameter_sets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "example_robots.hpp"
#include "random_chains.hpp"
#include "reference.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

using Links = std::vector<LinkParameters>;
using Rows = std::vector<Links>;

// All quantities of one robot in one state.
struct Quantities {
  explicit Quantities(Eigen::Index n) : H(n, n), c(n), g(n), tau(n) {}
  MatrixX<double> H;
  VectorX<double> c, g, tau;
};

Quantities quantitiesOf(const Chain& chain, const State<double>& state) {
  Quantities out(chain.jointCount());
  dynamicComponents(chain, state.q, state.qd, out.H, out.c, out.g);
  torques(chain, state.q, state.qd, state.qdd, out.tau);
  return out;
}

Quantities quantitiesOf(const Chain& chain, const ParameterSets& sets, const State<double>& state) {
  Quantities out(chain.jointCount());
  dynamicComponents(chain, sets, state.q, state.qd, out.H, out.c, out.g);
  torques(chain, sets, state.q, state.qd, state.qdd, out.tau);
  return out;
}

// The quantities that a chain with set j has in its row j: one whole chain per row.
Quantities rowByRow(const Chain& chain, const Rows& rows, const State<double>& state) {
  Quantities out(chain.jointCount());
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    const Chain own("own", chain.joints(), rows[static_cast<std::size_t>(j)], chain.gravity());
    const Quantities all = quantitiesOf(own, state);
    out.H.row(j) = all.H.row(j);
    out.c[j] = all.c[j];
    out.g[j] = all.g[j];
    out.tau[j] = all.tau[j];
  }
  return out;
}

void expectSame(const Chain& chain, const Quantities& a, const Quantities& b,
                const State<double>& state) {
  const double terms =
      largest(b.H.cwiseAbs() * state.qdd.cwiseAbs()) + largest(b.c) + largest(b.g) + largest(b.tau);
  EXPECT_TRUE(agree(a.H, b.H, largest(b.H), rounding(chain))) << "H";
  EXPECT_TRUE(agree(a.c, b.c, terms, rounding(chain))) << "c";
  EXPECT_TRUE(agree(a.g, b.g, terms, rounding(chain))) << "g";
  EXPECT_TRUE(agree(a.tau, b.tau, terms, rounding(chain))) << "tau";
}

TEST(ParameterSets, OfTheChainItselfChangeNothing) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Quantities expected = quantitiesOf(chain, state);
    const Rows none;
    const Rows same(static_cast<std::size_t>(chain.jointCount()), chain.links());
    const Links no_links;
    expectSame(chain, quantitiesOf(chain, ParameterSets{none, no_links}, state), expected, state);
    expectSame(chain, quantitiesOf(chain, ParameterSets{same, no_links}, state), expected, state);
    expectSame(chain, quantitiesOf(chain, ParameterSets{none, chain.links()}, state), expected,
               state);
    expectSame(chain, quantitiesOf(chain, ParameterSets{same, chain.links()}, state), expected,
               state);
  });
}

TEST(ParameterSets, RowsAreThoseOfAChainPerRow) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Rows rows = randomIdentifiedRows(chain);
    const Links none;
    expectSame(chain, quantitiesOf(chain, ParameterSets{rows, none}, state),
               rowByRow(chain, rows, state), state);
  });
}

TEST(ParameterSets, OfGravityReplaceThatOfEveryRow) {
  forEachState([](const Chain& chain, const State<double>& state) {
    Random random(11);
    const Links gravity = randomIdentifiedLinks(random, chain);
    const Chain heavy("heavy", chain.joints(), gravity, chain.gravity());
    for (const Rows& rows : {Rows(), randomIdentifiedRows(chain)}) {
      Quantities expected =
          rows.empty() ? quantitiesOf(chain, state) : rowByRow(chain, rows, state);
      expected.g = quantitiesOf(heavy, state).g;
      expected.tau = expected.H * state.qdd + expected.c + expected.g;
      expectSame(chain, quantitiesOf(chain, ParameterSets{rows, gravity}, state), expected, state);
    }
  });
}

TEST(ParameterSets, InSingleFunctionsGiveWhatDynamicComponentsGive) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Rows rows = randomIdentifiedRows(chain);
    const Links gravity = rows.back();
    for (const Links& own : {Links(), gravity}) {
      const ParameterSets sets{rows, own};
      const Quantities expected = quantitiesOf(chain, sets, state);
      Quantities single = expected;
      inertiaMatrix(chain, sets, state.q, single.H);
      coriolisVector(chain, sets, state.q, state.qd, single.c);
      gravityVector(chain, sets, state.q, single.g);
      expectSame(chain, single, expected, state);
    }
  });
}

TEST(ParameterSets, TorquesMayOverwriteAnInput) {
  const Chain chain = randomChain(4);
  State<double> state = randomState(chain, 0);
  const Rows rows = randomIdentifiedRows(chain);
  const ParameterSets sets{rows, rows[0]};
  const VectorX<double> expected = quantitiesOf(chain, sets, state).tau;
  torques(chain, sets, state.q, state.qd, state.qdd, state.qdd);
  EXPECT_EQ(state.qdd, expected);
}

std::string errorOf(const Chain& chain, const Rows& rows, const Links& gravity) {
  return chain_dynamics::errorOf([&] { checkParameterSets(chain, ParameterSets{rows, gravity}); });
}

TEST(CheckParameterSets, AcceptsWhatFitsAndNegativeMasses) {
  const Chain chain = randomChain(3);
  Rows rows(3, chain.links());
  rows[1][2].mass = -1;
  EXPECT_EQ(errorOf(chain, {}, {}), "no error");
  EXPECT_EQ(errorOf(chain, rows, rows[0]), "no error");
}

TEST(CheckParameterSets, NamesTheSetAndTheJointThatDoNotFit) {
  const Chain chain = randomChain(3);
  Rows rows(3, chain.links());
  EXPECT_EQ(errorOf(chain, Rows(2, chain.links()), {}),
            "chain random3: parameter sets: expected none, or one per joint (3), got 2");
  EXPECT_EQ(errorOf(chain, {}, Links(2, chain.links()[0])),
            "chain random3: parameter set of gravity: links: expected one per joint (3), got 2");
  rows[1].pop_back();
  EXPECT_EQ(errorOf(chain, rows, {}),
            "chain random3: parameter set of joint joint2: links: expected one per joint (3), "
            "got 2");
  rows[1] = chain.links();
  rows[1][2].mass = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(errorOf(chain, rows, {}),
            "chain random3: parameter set of joint joint2: link moved by joint joint3: expected "
            "ten finite numbers, got a NaN or an infinity");
}

}  // namespace
}  // namespace chain_dynamics
