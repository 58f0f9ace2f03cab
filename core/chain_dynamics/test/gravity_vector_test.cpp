// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/gravity_vector.hpp"

#include <gtest/gtest.h>

#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

VectorX<double> gravityOf(const Chain& chain, const VectorX<double>& q) {
  VectorX<double> g(chain.jointCount());
  gravityVector(chain, q, g);
  return g;
}

// What gravity torques are made of, cancelling or not: the whole weight, times a reach of 1 m.
double weightOf(const Chain& chain) {
  double mass = 0;
  for (const LinkParameters& link : chain.links()) {
    mass += link.mass;
  }
  return mass * chain.gravity().norm();
}

// A lift carries all that hangs on it, 2 kg and 3 kg, wherever that is.
TEST(GravityVector, OfALiftIsTheWeight) {
  Joint lift;
  lift.name = "lift";
  lift.type = JointType::kPrismatic;
  Joint arm;
  arm.name = "arm";
  const Chain chain("lift", {lift, arm}, {pointMass(2, {1, 2, 3}), pointMass(3, {4, 5, 6})},
                    {0, 0, -10});
  const VectorX<double> g = gravityOf(chain, Eigen::Vector2d(0.3, 0.4));
  EXPECT_TRUE(agree(g, Eigen::Vector2d(50, 0), 10, kByHand));
}

TEST(GravityVector, IsTheGradientOfPotentialEnergy) {
  forEachState([](const Chain& chain, const State<double>& state) {
    EXPECT_TRUE(agree(gravityOf(chain, state.q), gradientOfPotentialEnergy(chain, state.q),
                      weightOf(chain), rounding(chain)));
  });
}

}  // namespace
}  // namespace chain_dynamics
