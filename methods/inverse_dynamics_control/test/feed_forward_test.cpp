// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/feed_forward.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"

namespace inverse_dynamics_control::feed_forward_test {

constexpr double kPeriod = 1e-3;  // s

const JointState kState = stateOf(vec({1.0}), vec({0.5}));
const Reference kReference = referenceOf(vec({1.2}), vec({0.4}), vec({3.0}));

double torqueOf(ModelState at, const LawOptions& options) {
  FeedForward law(Pendulum::make(), at, options);
  Eigen::VectorXd tau(1);
  EXPECT_EQ(law.update(kState, kReference, vec({7.0}), kPeriod, tau), Status::kOk);
  return tau[0];
}

TEST(FeedForward, PendulumByHand) {
  EXPECT_NEAR(torqueOf(ModelState::kReference, unlimited(1)), 7 + 0.5 * 3 + 9.81 * std::cos(1.2),
              kRounding);
  EXPECT_NEAR(torqueOf(ModelState::kMeasured, unlimited(1)), 7 + 0.5 * 3 + 9.81 * std::cos(1.0),
              kRounding);
}

TEST(FeedForward, WhatTheRobotCompensatesIsLeftOut) {
  LawOptions options = unlimited(1);
  options.friction.source = FrictionSource::kReferenceVelocity;
  EXPECT_NEAR(torqueOf(ModelState::kReference, options),
              8.5 + 9.81 * std::cos(1.2) + Pendulum::friction(0.4), kRounding);
  options.compensated.friction = true;
  EXPECT_NEAR(torqueOf(ModelState::kReference, options), 8.5 + 9.81 * std::cos(1.2), kRounding);
  options.compensated.gravity = true;
  EXPECT_NEAR(torqueOf(ModelState::kReference, options), 8.5, kRounding);
}

}  // namespace inverse_dynamics_control::feed_forward_test
