// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/coriolis_vector.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
VectorX<Scalar> coriolisOf(const Chain& chain, const VectorX<Scalar>& q,
                           const VectorX<Scalar>& qd) {
  VectorX<Scalar> c(chain.jointCount());
  coriolisVector(chain, q, qd, c);
  return c;
}

// dH/dt along the motion.
MatrixX<double> rateOfInertia(const Chain& chain, const State<double>& state) {
  MatrixX<Dual<double, 1>> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, moving<double>(state.q, state.qd), H);
  return H.unaryExpr([](const Dual<double, 1>& x) { return x.derivative[0]; });
}

// The size of the terms that the Coriolis torques are the sum of, cancelling or not.
double coriolisTermsOf(const Chain& chain, const State<double>& state) {
  const MatrixX<double> rate = rateOfInertia(chain, state);
  return largest(rate.cwiseAbs() * state.qd.cwiseAbs()) +
         largest(coriolisOf(chain, state.q, state.qd));
}

// Derived in torques_test.cpp: with k = m2 l1 l2,
//   c1 = -k sin q2 (2 qd1 qd2 + qd2^2), c2 = k sin q2 qd1^2
TEST(CoriolisVector, OfADoublePendulumByHand) {
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  const double k_s2 = 0.8 * 0.6 * 0.4 * std::sin(-1.1);
  const Eigen::Vector2d expected(-k_s2 * (2 * 1.3 * 0.9 + 0.9 * 0.9), k_s2 * 1.3 * 1.3);
  EXPECT_TRUE(
      agree(coriolisOf<double>(chain, Eigen::Vector2d(0.4, -1.1), Eigen::Vector2d(1.3, 0.9)),
            expected, 1, kByHand));
}

// Polar coordinates: 2 m r r' phi' about the axis, -m r phi'^2 along the radius.
TEST(CoriolisVector, OfATurntableWithASlideByHand) {
  const Eigen::Vector2d expected(2 * 3 * 0.4 * -0.7 * 2, -3 * 0.4 * 2 * 2);
  EXPECT_TRUE(
      agree(coriolisOf<double>(turntable(3), Eigen::Vector2d(0.3, 0.4), Eigen::Vector2d(2, -0.7)),
            expected, 1, kByHand));
}

TEST(CoriolisVector, IsThatOfLagrangesEquation) {
  forEachState([](const Chain& chain, const State<double>& state) {
    State<double> unaccelerated = state;
    unaccelerated.qdd.setZero();
    EXPECT_TRUE(agree(coriolisOf(chain, state.q, state.qd),
                      lagrangeOfKineticEnergy(chain, unaccelerated), coriolisTermsOf(chain, state),
                      rounding(chain)));
  });
}

// qd' (dH/dt - 2 C) qd = 0: Coriolis torques only pass energy on from joint to joint.
TEST(CoriolisVector, ChangesNoEnergy) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const double power = state.qd.dot(coriolisOf(chain, state.q, state.qd));
    const double rate = state.qd.dot(rateOfInertia(chain, state) * state.qd);
    const double scale =
        coriolisTermsOf(chain, state) * static_cast<double>(state.qd.cwiseAbs().sum());
    EXPECT_NEAR(2 * power, rate, rounding(chain) * scale);
  });
}

// Powers of two are exact, so is the result.
TEST(CoriolisVector, GrowsWithTheSquareOfTheVelocity) {
  forEachState([](const Chain& chain, const State<double>& state) {
    EXPECT_EQ(coriolisOf<double>(chain, state.q, 4 * state.qd),
              16 * coriolisOf(chain, state.q, state.qd));
  });
}

TEST(CoriolisVector, IsZeroAtRestAndIgnoresGravity) {
  const Chain chain = randomChain(6);
  const State<double> state = randomState(chain, 1);
  EXPECT_EQ(coriolisOf<double>(chain, state.q, VectorX<double>::Zero(6)).norm(), 0);
  EXPECT_EQ(coriolisOf(chain.withGravity({0, 0, 0}), state.q, state.qd),
            coriolisOf(chain, state.q, state.qd));
}

}  // namespace
}  // namespace chain_dynamics
