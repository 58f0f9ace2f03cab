// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/inertia_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
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
MatrixX<Scalar> inertiaMatrixOf(const Chain& chain, const VectorX<Scalar>& q) {
  MatrixX<Scalar> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, q, H);
  return H;
}

TEST(InertiaMatrix, OfAPendulumIsMassTimesLengthSquaredAndRotor) {
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_NEAR(inertiaMatrixOf(pendulum(2, 0.5, 9.81, 0.25), q)(0, 0), 0.75, kByHand);
}

// Derived in torques_test.cpp: with k = m2 l1 l2,
//   H11 = (m1 + m2) l1^2 + m2 l2^2 + 2 k cos q2, H12 = m2 l2^2 + k cos q2, H22 = m2 l2^2
TEST(InertiaMatrix, OfADoublePendulumByHand) {
  const Eigen::Vector2d q(0.4, -1.1);
  const double k = 0.8 * 0.6 * 0.4;
  const double H22 = 0.8 * 0.4 * 0.4;
  const double H12 = H22 + k * std::cos(-1.1);
  const double H11 = (1.5 + 0.8) * 0.6 * 0.6 + H22 + 2 * k * std::cos(-1.1);
  Eigen::Matrix2d expected;
  expected << H11, H12, H12, H22;
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  EXPECT_TRUE(agree(inertiaMatrixOf<double>(chain, q), expected, 1, kByHand));
}

// A mass at radius r on a turntable: m r^2 about the axis, m along the radius, nothing mixed.
TEST(InertiaMatrix, OfATurntableWithASlideByHand) {
  Eigen::Matrix2d expected;
  expected << 3 * 0.4 * 0.4, 0, 0, 3;
  EXPECT_TRUE(agree(inertiaMatrixOf<double>(turntable(3), Eigen::Vector2d(0.3, 0.4)), expected, 1,
                    kByHand));
}

// u' H v = d^2 T / (du dv): derivative along u of the derivative along v, for random u and v.
TEST(InertiaMatrix, IsTheSecondDerivativeOfKineticEnergy) {
  using Once = Dual<double, 1>;
  using Twice = Dual<Once, 1>;
  forEachState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> u = state.qd;
    const VectorX<double> v = state.qdd;
    const MatrixX<double> H = inertiaMatrixOf(chain, state.q);
    const VectorX<Once> zero = VectorX<Once>::Zero(chain.jointCount());
    const VectorX<Twice> qd =
        moving<Once>(moving<double>(VectorX<double>::Zero(u.size()), u), zero + v.cast<Once>());
    const VectorX<Twice> q = state.q.cast<Twice>();
    const double expected = kineticEnergy(chain, q, qd).derivative[0].derivative[0];
    const double scale = u.cwiseAbs().dot(H.cwiseAbs() * v.cwiseAbs());
    EXPECT_NEAR(u.dot(H * v), expected, rounding(chain) * scale);
  });
}

TEST(InertiaMatrix, IsTheDerivativeOfTorqueByAcceleration) {
  using Varied = Dual<double, 1>;
  forEachState([](const Chain& chain, const State<double>& state) {
    const MatrixX<double> H = inertiaMatrixOf(chain, state.q);
    const State<Varied> varied = state.cast<Varied>();
    for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
      VectorX<Varied> tau(chain.jointCount());
      torques(chain, varied.q, varied.qd, variable(state.qdd, j), tau);
      const VectorX<double> column = tau.unaryExpr([](const Varied& x) { return x.derivative[0]; });
      EXPECT_TRUE(agree(H.col(j), column, largest(H), rounding(chain)));
    }
  });
}

TEST(InertiaMatrix, IsExactlySymmetric) {
  forEachState([](const Chain& chain, const State<double>& state) {
    const MatrixX<double> H = inertiaMatrixOf(chain, state.q);
    EXPECT_EQ(H, H.transpose());
  });
}

// The smallest eigenvalue of a long chain is far below the largest; rounding must not reach it.
TEST(InertiaMatrix, IsPositiveDefinite) {
  forEachState([](const Chain& chain, const State<double>& state) {
    MatrixX<double> H = inertiaMatrixOf(chain, state.q);
    H.diagonal().array() -= 1e-12 * H.trace();  // the sum of all eigenvalues
    EXPECT_EQ(H.llt().info(), Eigen::Success);
  });
}

TEST(InertiaMatrix, DependsNeitherOnGravityNorOnTheFirstJoint) {
  const Chain chain = randomChain(5);
  const State<double> state = randomState(chain, 1);
  const MatrixX<double> H = inertiaMatrixOf(chain, state.q);
  VectorX<double> turned = state.q;
  turned[0] += 1;
  EXPECT_EQ(inertiaMatrixOf(chain.withGravity({0, 0, 0}), state.q), H);
  EXPECT_EQ(inertiaMatrixOf(chain, turned), H);
}

TEST(InertiaMatrix, GoesIntoABlockOfAMatrix) {
  const Chain chain = randomChain(4);
  const State<double> state = randomState(chain, 2);
  MatrixX<double> batch = MatrixX<double>::Zero(4, 12);
  inertiaMatrix(chain, state.q, batch.middleCols(4, 4));
  EXPECT_EQ(batch.middleCols(4, 4), inertiaMatrixOf(chain, state.q));
  EXPECT_EQ(batch.leftCols(4).norm() + batch.rightCols(4).norm(), 0);
}

}  // namespace
}  // namespace chain_dynamics
