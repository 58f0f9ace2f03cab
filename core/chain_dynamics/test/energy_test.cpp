// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/energy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain_dynamics/inertia_matrix.hpp"
#include "example_robots.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// 1/2 (m l^2 + J) qd^2, and m g times the height l sin q.
TEST(Energy, OfAPendulumByHand) {
  const Chain chain = pendulum(2, 0.5, 9.81, 0.25);
  const Eigen::Matrix<double, 1, 1> q(0.7);
  const Eigen::Matrix<double, 1, 1> qd(3.0);
  EXPECT_NEAR(kineticEnergy(chain, q, qd), 0.5 * 0.75 * 9, 10 * kByHand);
  EXPECT_NEAR(potentialEnergy(chain, q), 2 * 9.81 * 0.5 * std::sin(0.7), 10 * kByHand);
}

// Heights and speeds of two points as in torques_test.cpp.
TEST(Energy, OfADoublePendulumByHand) {
  const Chain chain = doublePendulum(1.5, 0.6, 0.8, 0.4, 9.81);
  const Eigen::Vector2d q(0.4, -1.1);
  const Eigen::Vector2d qd(1.3, 0.9);
  const double w = 1.3 + 0.9;
  const double v1_squared = 0.6 * 0.6 * 1.3 * 1.3;
  const double v2_squared =
      v1_squared + 0.4 * 0.4 * w * w + 2 * 0.6 * 0.4 * std::cos(-1.1) * 1.3 * w;
  EXPECT_NEAR(kineticEnergy(chain, q, qd), 0.5 * 1.5 * v1_squared + 0.5 * 0.8 * v2_squared,
              10 * kByHand);

  const double height1 = 0.6 * std::sin(0.4);
  const double height2 = height1 + 0.4 * std::sin(0.4 - 1.1);
  EXPECT_NEAR(potentialEnergy(chain, q), 9.81 * (1.5 * height1 + 0.8 * height2), 10 * kByHand);
}

TEST(Energy, IsHalfOfVelocityTimesInertiaTimesVelocity) {
  forEachState([](const Chain& chain, const State<double>& state) {
    MatrixX<double> H(chain.jointCount(), chain.jointCount());
    inertiaMatrix(chain, state.q, H);
    const double terms = state.qd.cwiseAbs().dot(H.cwiseAbs() * state.qd.cwiseAbs());
    EXPECT_NEAR(kineticEnergy(chain, state.q, state.qd), 0.5 * state.qd.dot(H * state.qd),
                rounding(chain) * terms);
  });
}

}  // namespace
}  // namespace chain_dynamics
