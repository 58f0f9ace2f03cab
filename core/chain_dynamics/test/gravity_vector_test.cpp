// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/gravity_vector.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
VectorX<Scalar> gravityOf(const Chain& chain, const VectorX<Scalar>& q) {
  VectorX<Scalar> g(chain.jointCount());
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

TEST(GravityVector, OfAPendulumIsItsWeightTimesItsHorizontalReach) {
  const Chain chain = pendulum(2, 0.5, 9.81);
  for (const double q : {0.0, 0.7, -2.5}) {
    EXPECT_NEAR(gravityOf<double>(chain, VectorX<double>::Constant(1, q))[0],
                2 * 9.81 * 0.5 * std::cos(q), 10 * kByHand);
  }
}

// Derived in torques_test.cpp.
TEST(GravityVector, OfADoublePendulumByHand) {
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  const double g2 = 0.8 * 9.81 * 0.4 * std::cos(0.4 - 1.1);
  const double g1 = (1.5 + 0.8) * 9.81 * 0.6 * std::cos(0.4) + g2;
  EXPECT_TRUE(agree(gravityOf<double>(chain, Eigen::Vector2d(0.4, -1.1)), Eigen::Vector2d(g1, g2),
                    10, kByHand));
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
  const VectorX<double> g = gravityOf<double>(chain, Eigen::Vector2d(0.3, 0.4));
  EXPECT_TRUE(agree(g, Eigen::Vector2d(50, 0), 10, kByHand));
}

TEST(GravityVector, IsTheGradientOfPotentialEnergy) {
  forEachState([](const Chain& chain, const State<double>& state) {
    EXPECT_TRUE(agree(gravityOf(chain, state.q), gradientOfPotentialEnergy(chain, state.q),
                      weightOf(chain), rounding(chain)));
  });
}

TEST(GravityVector, IsTheTorqueAtRest) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> rest = VectorX<double>::Zero(chain.jointCount());
    VectorX<double> tau(chain.jointCount());
    torques(chain, state.q, rest, rest, tau);
    EXPECT_TRUE(agree(gravityOf(chain, state.q), tau, weightOf(chain), rounding(chain)));
  });
}

// dg_i/dq_j = d^2 U / (dq_i dq_j)
TEST(GravityVector, HasASymmetricJacobian) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> jacobian(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto g = gravityOf(chain, variable(state.q, j));
      for (Eigen::Index i = 0; i < n; ++i) {
        jacobian(i, j) = g[i].derivative[0];
      }
    }
    EXPECT_TRUE(agree(jacobian, jacobian.transpose(), weightOf(chain), rounding(chain)));
  });
}

TEST(GravityVector, IsZeroInFreeFallAndTurnsAroundWithGravity) {
  const Chain chain = randomChain(6);
  const VectorX<double> q = randomState(chain, 1).q;
  EXPECT_EQ(gravityOf(chain.withGravity({0, 0, 0}), q).norm(), 0);
  EXPECT_EQ(gravityOf(chain.withGravity(-chain.gravity()), q), -gravityOf(chain, q));
}

}  // namespace
}  // namespace chain_dynamics
