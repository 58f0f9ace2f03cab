// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/torque_derivatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "example_robots.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

struct Derivatives {
  explicit Derivatives(Eigen::Index n) : q(n, n), qd(n, n), qdd(n, n) {
    for (MatrixX<double>* matrix : {&q, &qd, &qdd}) {
      matrix->setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  MatrixX<double> q, qd, qdd;
};

Derivatives derivativesOf(const Chain& chain, const State<double>& x) {
  Derivatives d(chain.jointCount());
  torqueDerivatives(chain, x.q, x.qd, x.qdd, d.q, d.qd, d.qdd);
  return d;
}

// tau = (m l^2 + J) qdd + m g l cos q
TEST(TorqueDerivatives, OfAPendulumByHand) {
  const Chain chain = pendulum(2, 0.5, 9.81, 0.25);
  State<double> x{VectorX<double>(1), VectorX<double>(1), VectorX<double>(1)};
  x.q << 0.7;
  x.qd << 2;
  x.qdd << -3;
  const Derivatives d = derivativesOf(chain, x);
  EXPECT_NEAR(d.q(0, 0), -2 * 9.81 * 0.5 * std::sin(0.7), 10 * kByHand);
  EXPECT_NEAR(d.qd(0, 0), 0, 10 * kByHand);
  EXPECT_NEAR(d.qdd(0, 0), 0.75, 10 * kByHand);
}

// A mass at radius r on a turntable: tau = m (r^2 phi'' + 2 r r' phi'), f = m (r'' - r phi'^2).
TEST(TorqueDerivatives, OfATurntableByHand) {
  const double m = 3, r = 0.4, rd = -0.7, rdd = 1.1, phid = 2, phidd = 5;
  State<double> x{VectorX<double>(2), VectorX<double>(2), VectorX<double>(2)};
  x.q << 0.3, r;
  x.qd << phid, rd;
  x.qdd << phidd, rdd;
  const Derivatives d = derivativesOf(turntable(m), x);
  Derivatives expected(2);
  expected.q << 0, m * (2 * r * phidd + 2 * rd * phid), 0, -m * phid * phid;
  expected.qd << 2 * m * r * rd, 2 * m * r * phid, -2 * m * r * phid, 0;
  expected.qdd << m * r * r, 0, 0, m;
  EXPECT_TRUE(agree(d.q, expected.q, 10, kByHand));
  EXPECT_TRUE(agree(d.qd, expected.qd, 10, kByHand));
  EXPECT_TRUE(agree(d.qdd, expected.qdd, 10, kByHand));
}

}  // namespace
}  // namespace chain_dynamics
