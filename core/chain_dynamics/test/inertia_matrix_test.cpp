// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/inertia_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/energy.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

MatrixX<double> inertiaMatrixOf(const Chain& chain, const VectorX<double>& q) {
  MatrixX<double> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, q, H);
  return H;
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
