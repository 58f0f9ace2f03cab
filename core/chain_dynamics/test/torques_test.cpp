// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/torques.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
VectorX<Scalar> torquesOf(const Chain& chain, const State<Scalar>& state) {
  VectorX<Scalar> tau(chain.jointCount());
  torques(chain, state.q, state.qd, state.qdd, tau);
  return tau;
}

// The size of the terms that make up the torques, cancelling or not.
double termsOf(const Chain& chain, const State<double>& state) {
  const Eigen::Index n = chain.jointCount();
  MatrixX<double> H(n, n);
  VectorX<double> c(n);
  VectorX<double> g(n);
  dynamicComponents(chain, state.q, state.qd, H, c, g);
  return largest(H.cwiseAbs() * state.qdd.cwiseAbs() + c.cwiseAbs() + g.cwiseAbs());
}

// Point mass m on a rod l, rod at angle q above the horizontal. About the pivot:
//   inertia  m l^2, with a rotor J on the same axis m l^2 + J
//   weight   m g at horizontal distance l cos q, pulling down: the motor must hold + m g l cos q
//   no Coriolis torque, as nothing depends on q but gravity.
TEST(Torques, OfAPendulumByHand) {
  const double m = 2;
  const double l = 0.5;
  const double J = 0.25;
  const Chain chain = pendulum(m, l, 9.81, J);
  const double q = 0.7;
  const double qdd = -3;
  State<double> state{VectorX<double>(1), VectorX<double>(1), VectorX<double>(1)};
  state.q << q;
  state.qd << 100;  // of no influence
  state.qdd << qdd;
  EXPECT_NEAR(torquesOf(chain, state)[0], (m * l * l + J) * qdd + m * 9.81 * l * std::cos(q),
              10 * kByHand);
}

// Two point masses on rods l1, l2, angles q1 from the horizontal and q2 between the rods, so the
// second rod stands at q1 + q2. Positions and velocities (w = qd1 + qd2):
//   p1 = l1 (cos q1, sin q1)                      |v1|^2 = l1^2 qd1^2
//   p2 = p1 + l2 (cos(q1+q2), sin(q1+q2))         |v2|^2 = l1^2 qd1^2 + l2^2 w^2
//                                                          + 2 l1 l2 cos q2 qd1 w
//   T = 1/2 m1 |v1|^2 + 1/2 m2 |v2|^2,  U = m1 g l1 sin q1 + m2 g (l1 sin q1 + l2 sin(q1+q2))
// Lagrange's equations d/dt dT/dqd - dT/dq + dU/dq = tau give, with k = m2 l1 l2:
//   H11 = (m1 + m2) l1^2 + m2 l2^2 + 2 k cos q2     H12 = m2 l2^2 + k cos q2    H22 = m2 l2^2
//   c1 = -k sin q2 (2 qd1 qd2 + qd2^2)              c2 = k sin q2 qd1^2
//   g1 = (m1 + m2) g l1 cos q1 + m2 g l2 cos(q1+q2) g2 = m2 g l2 cos(q1+q2)
TEST(Torques, OfADoublePendulumByHand) {
  const double m1 = 1.5;
  const double m2 = 0.8;
  const double l1 = 0.6;
  const double l2 = 0.4;
  const double gravity = 9.81;
  const Chain chain = doublePendulum(m1, l1, m2, l2, gravity);
  State<double> state{VectorX<double>(2), VectorX<double>(2), VectorX<double>(2)};
  state.q << 0.4, -1.1;
  state.qd << 1.3, 0.9;
  state.qdd << -2, 3.5;

  const double k = m2 * l1 * l2;
  const double s2 = std::sin(-1.1);
  const double c2 = std::cos(-1.1);
  const double H11 = (m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2 * k * c2;
  const double H12 = m2 * l2 * l2 + k * c2;
  const double H22 = m2 * l2 * l2;
  const double g2 = m2 * gravity * l2 * std::cos(0.4 - 1.1);
  const double g1 = (m1 + m2) * gravity * l1 * std::cos(0.4) + g2;
  const Eigen::Vector2d expected(H11 * -2 + H12 * 3.5 - k * s2 * (2 * 1.3 * 0.9 + 0.9 * 0.9) + g1,
                                 H12 * -2 + H22 * 3.5 + k * s2 * 1.3 * 1.3 + g2);
  EXPECT_TRUE(agree(torquesOf(chain, state), expected, 10, kByHand));
}

// A mass m at radius r on a turntable, in polar coordinates (phi, r):
//   torque about the axis   m r^2 phi'' + 2 m r r' phi'     (Coriolis)
//   force along the radius  m r'' - m r phi'^2              (centrifugal)
// Gravity is parallel to the axis and does nothing.
TEST(Torques, OfATurntableWithASlideByHand) {
  const double m = 3;
  const Chain chain = turntable(m);
  const double r = 0.4;
  State<double> state{VectorX<double>(2), VectorX<double>(2), VectorX<double>(2)};
  state.q << 0.3, r;
  state.qd << 2, -0.7;
  state.qdd << 1.5, 4;
  const Eigen::Vector2d expected(m * r * r * 1.5 + 2 * m * r * -0.7 * 2, m * 4 - m * r * 2 * 2);
  EXPECT_TRUE(agree(torquesOf(chain, state), expected, 10, kByHand));
}

// The oracle differentiates energies twice; its sums are longer than those of the recursion.
TEST(Torques, AreThoseOfLagrangesEquation) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> expected =
        lagrangeOfKineticEnergy(chain, state) + gradientOfPotentialEnergy(chain, state.q);
    EXPECT_TRUE(agree(torquesOf(chain, state), expected, termsOf(chain, state), rounding(chain)));
  });
}

TEST(Torques, AreTheSumOfTheTermsOfTheEquationOfMotion) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> H(n, n);
    VectorX<double> c(n);
    VectorX<double> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);
    EXPECT_TRUE(agree(torquesOf(chain, state), H * state.qdd + c + g, termsOf(chain, state),
                      rounding(chain)));
  });
}

// What each torque changes by, at most, when every angle is off by one unit.
double sensitivityToAngles(const Chain& chain, const State<double>& state) {
  const State<Dual<double, 1>> constants = state.cast<Dual<double, 1>>();
  VectorX<double> sum = VectorX<double>::Zero(chain.jointCount());
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    VectorX<Dual<double, 1>> tau(chain.jointCount());
    torques(chain, variable(state.q, i), constants.qd, constants.qdd, tau);
    sum += tau.unaryExpr([](const Dual<double, 1>& x) { return std::abs(x.derivative[0]); });
  }
  return largest(sum);
}

// Whole turns change nothing, even a thousand of them: sine and cosine are as exact as the angle,
// which at 1e4 rad a double states to 1e-12, as it does 1600 times 2 pi. Slides stay where they
// are.
TEST(Torques, AreTheSameAfterManyTurns) {
  constexpr double kAngleRounding = 2e-12;
  const double turn = 2 * std::acos(-1.0);
  forEachState([turn](const Chain& chain, const State<double>& state) {
    State<double> turned = state;
    for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
      const double turns = i % 2 == 0 ? 1600 : -1590;
      turned.q[i] += isPrismatic(internal::joint(chain, i)) ? 0 : turns * turn;
    }
    EXPECT_TRUE(agree(torquesOf(chain, turned), torquesOf(chain, state),
                      sensitivityToAngles(chain, state), kAngleRounding));
  });
}

TEST(Torques, MayOverwriteAnInput) {
  const Chain chain = randomChain(5);
  State<double> state = randomState(chain, 3);
  const VectorX<double> expected = torquesOf(chain, state);
  torques(chain, state.q, state.qd, state.qdd, state.qdd);
  EXPECT_EQ(state.qdd, expected);
}

TEST(Torques, GoIntoAColumnOfAMatrix) {
  const Chain chain = randomChain(5);
  const State<double> state = randomState(chain, 3);
  MatrixX<double> tau = MatrixX<double>::Zero(5, 3);
  torques(chain, state.q, state.qd, state.qdd, tau.col(1));
  EXPECT_EQ(tau.col(1), torquesOf(chain, state));
  EXPECT_EQ(tau.col(0).norm() + tau.col(2).norm(), 0);
}

}  // namespace
}  // namespace chain_dynamics
