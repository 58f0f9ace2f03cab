// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/torque_derivatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/parameter_sets.hpp"
#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
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

Derivatives derivativesOf(const Chain& chain, const ParameterSets& sets, const State<double>& x) {
  Derivatives d(chain.jointCount());
  torqueDerivatives(chain, sets, x.q, x.qd, x.qdd, d.q, d.qd, d.qdd);
  return d;
}

// The same from the torques of dual numbers, one direction after the other.
template <typename Torques>
Derivatives byDualNumbers(const State<double>& x, const Torques& torques_of) {
  const Eigen::Index n = x.q.size();
  const auto constants = x.cast<Dual<double, 1>>();
  const auto derivative = [&](const State<Dual<double, 1>>& varied) {
    VectorX<Dual<double, 1>> tau(n);
    torques_of(varied, tau);
    return tau.unaryExpr([](const auto& t) { return t.derivative[0]; }).eval();
  };
  Derivatives d(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    d.q.col(j) = derivative({variable(x.q, j), constants.qd, constants.qdd});
    d.qd.col(j) = derivative({constants.q, variable(x.qd, j), constants.qdd});
    d.qdd.col(j) = derivative({constants.q, constants.qd, variable(x.qdd, j)});
  }
  return d;
}

void expectSame(const Chain& chain, const Derivatives& a, const Derivatives& b) {
  const double tolerance = rounding(chain);
  EXPECT_TRUE(agree(a.q, b.q, largest(b.q), tolerance)) << "by q";
  EXPECT_TRUE(agree(a.qd, b.qd, largest(b.qd), tolerance)) << "by qd";
  EXPECT_TRUE(agree(a.qdd, b.qdd, largest(b.qdd), tolerance)) << "by qdd";
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

TEST(TorqueDerivatives, AreThoseOfDualNumbers) {
  forEachState([](const Chain& chain, const State<double>& x) {
    expectSame(chain, derivativesOf(chain, x), byDualNumbers(x, [&](const auto& varied, auto& tau) {
                 torques(chain, varied.q, varied.qd, varied.qdd, tau);
               }));
  });
}

TEST(TorqueDerivatives, HoldAtLargeAngles) {
  const Chain chain = randomChain(6);
  for (const double angle : {1e4, -1e7}) {
    State<double> x = randomState(chain, 2);
    x.q[0] = x.q[3] = angle;
    expectSame(chain, derivativesOf(chain, x), byDualNumbers(x, [&](const auto& varied, auto& tau) {
                 torques(chain, varied.q, varied.qd, varied.qdd, tau);
               }));
  }
}

TEST(TorqueDerivatives, OfParameterSetsAreThoseOfDualNumbers) {
  forEachState([](const Chain& chain, const State<double>& x) {
    if (chain.jointCount() > 9) return;
    Random random(7);
    std::vector<std::vector<LinkParameters>> rows;
    for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
      rows.push_back(randomIdentifiedLinks(random, chain));
    }
    const std::vector<LinkParameters> gravity = randomIdentifiedLinks(random, chain);
    for (const auto& own_rows : {decltype(rows)(), rows}) {
      for (const auto& own_gravity : {std::vector<LinkParameters>(), gravity}) {
        const ParameterSets sets{own_rows, own_gravity};
        expectSame(chain, derivativesOf(chain, sets, x),
                   byDualNumbers(x, [&](const auto& varied, auto& tau) {
                     torques(chain, sets, varied.q, varied.qd, varied.qdd, tau);
                   }));
      }
    }
  });
}

}  // namespace
}  // namespace chain_dynamics
