// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/coriolis_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
MatrixX<Scalar> coriolisMatrixOf(const Chain& chain, const VectorX<Scalar>& q,
                                 const VectorX<Scalar>& qd) {
  MatrixX<Scalar> C(chain.jointCount(), chain.jointCount());
  C.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  coriolisMatrix(chain, q, qd, C);
  return C;
}

MatrixX<double> rates(const MatrixX<Dual<double, 1>>& matrix) {
  return matrix.unaryExpr([](const Dual<double, 1>& x) { return x.derivative[0]; });
}

// dH/dt along the motion.
MatrixX<double> rateOfInertia(const Chain& chain, const VectorX<double>& q,
                              const VectorX<double>& qd) {
  MatrixX<Dual<double, 1>> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, moving<double>(q, qd), H);
  return rates(H);
}

// The size of the terms that C is the sum of, cancelling or not.
double termsOf(const Chain& chain, const State<double>& state, const MatrixX<double>& C) {
  return largest(C) + largest(rateOfInertia(chain, state.q, state.qd));
}

// Of H in torques_test.cpp: with k = m2 l1 l2,
//   C = k sin q2 [-qd2, -(qd1 + qd2); qd1, 0]
TEST(CoriolisMatrix, OfADoublePendulumByHand) {
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  const double k_s2 = 0.8 * 0.6 * 0.4 * std::sin(-1.1);
  Eigen::Matrix2d expected;
  expected << -k_s2 * 0.9, -k_s2 * (1.3 + 0.9), k_s2 * 1.3, 0;
  EXPECT_TRUE(
      agree(coriolisMatrixOf<double>(chain, Eigen::Vector2d(0.4, -1.1), Eigen::Vector2d(1.3, 0.9)),
            expected, 1, kByHand));
}

TEST(CoriolisMatrix, TimesVelocityIsTheCoriolisVector) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const MatrixX<double> C = coriolisMatrixOf(chain, state.q, state.qd);
    VectorX<double> c(chain.jointCount());
    coriolisVector(chain, state.q, state.qd, c);
    const double scale = termsOf(chain, state, C) * static_cast<double>(state.qd.cwiseAbs().sum());
    EXPECT_TRUE(agree((C * state.qd).eval(), c, scale, rounding(chain)));
  });
}

// dH/dt = C + C', so dH/dt - 2 C = C' - C is skew.
TEST(CoriolisMatrix, AndItsTransposeAreTheRateOfInertia) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const MatrixX<double> C = coriolisMatrixOf(chain, state.q, state.qd);
    EXPECT_TRUE(agree((C + C.transpose()).eval(), rateOfInertia(chain, state.q, state.qd),
                      termsOf(chain, state, C), rounding(chain)));
  });
}

TEST(CoriolisMatrix, IsZeroAtRestAndIgnoresGravityAndTheFirstJoint) {
  const Chain chain = randomChain(6);
  const State<double> state = randomState(chain, 1);
  const MatrixX<double> C = coriolisMatrixOf(chain, state.q, state.qd);
  EXPECT_EQ(coriolisMatrixOf<double>(chain, state.q, VectorX<double>::Zero(6)).norm(), 0);
  EXPECT_EQ(coriolisMatrixOf(chain.withGravity({0, 0, 0}), state.q, state.qd), C);
  VectorX<double> turned = state.q;
  turned[0] += 1;
  EXPECT_EQ(coriolisMatrixOf(chain, turned, state.qd), C);
}

}  // namespace
}  // namespace chain_dynamics
