// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/feed_forward.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp>

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

TEST(FeedForward, GivesTheTorquesOfTheIdentifiedUr10) {
  auto ur10 = std::make_shared<ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10>();
  ur10->initialize();
  LawOptions options = unlimited(6);
  options.friction.source = FrictionSource::kReferenceVelocity;
  FeedForward law(ur10, ModelState::kReference, options);
  const Reference r =
      referenceOf(Eigen::VectorXd::LinSpaced(6, -1, 1), Eigen::VectorXd::Constant(6, 0.5),
                  Eigen::VectorXd::LinSpaced(6, 2, -2));
  Eigen::VectorXd tau(6);
  EXPECT_EQ(law.update(JointState(6), r, Eigen::VectorXd::Zero(6), kPeriod, tau), Status::kOk);
  // rounding: torques of up to 100 N m, summed in another order
  EXPECT_LT((tau - ur10->getTorques(r.q, r.qd, r.qdd)).norm(), 1e-11);
}

}  // namespace inverse_dynamics_control::feed_forward_test
