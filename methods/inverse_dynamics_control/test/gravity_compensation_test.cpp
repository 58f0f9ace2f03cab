// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/gravity_compensation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"

namespace inverse_dynamics_control::gravity_compensation_test {

constexpr double kPeriod = 1e-3;  // s

double torqueOf(GravityCompensation& law, double q, double qd) {
  Eigen::VectorXd tau(1);
  EXPECT_EQ(law.update(stateOf(vec({q}), vec({qd})), kPeriod, tau), Status::kOk);
  return tau[0];
}

TEST(GravityCompensation, PendulumByHand) {
  GravityCompensation law(Pendulum::make(), unlimited(1));
  EXPECT_NEAR(torqueOf(law, 1.0, 0.0), 9.81 * std::cos(1.0), kRounding);
  EXPECT_NEAR(torqueOf(law, 1.0, 0.5), 9.81 * std::cos(1.0) - 4.0 * 0.5, kRounding);
}

TEST(GravityCompensation, CompensatedGravityIsLeftOut) {
  LawOptions options = unlimited(1);
  options.compensated.gravity = true;
  GravityCompensation law(Pendulum::make(), options);
  EXPECT_EQ(torqueOf(law, 1.0, 0.0), 0.0);
}

TEST(GravityCompensation, FrictionOfTheMeasuredVelocityBeyondTheDeadBand) {
  LawOptions options = unlimited(1);
  options.damping.setZero(1);
  options.friction = {FrictionSource::kMeasuredVelocity, 0.1, 0.2, 0.5};
  GravityCompensation law(Pendulum::make(), options);
  const double g = 9.81 * std::cos(1.0);
  EXPECT_NEAR(torqueOf(law, 1.0, 0.0), g, kRounding);
  EXPECT_NEAR(torqueOf(law, 1.0, -0.1), g, kRounding);
  EXPECT_NEAR(torqueOf(law, 1.0, 0.2), g + 0.25 * Pendulum::friction(0.2), kRounding);
  EXPECT_NEAR(torqueOf(law, 1.0, -1.0), g + 0.5 * Pendulum::friction(-1.0), kRounding);
  options.compensated.friction = true;
  GravityCompensation without(Pendulum::make(), options);
  EXPECT_NEAR(torqueOf(without, 1.0, -1.0), g, kRounding);
}

TEST(GravityCompensation, FrictionOfAGuidingVelocity) {
  LawOptions options = unlimited(1);
  options.friction = {FrictionSource::kReferenceVelocity, 0.0, 0.2, 1.0};
  GravityCompensation law(Pendulum::make(), options);
  const double g = 9.81 * std::cos(1.0);
  Eigen::VectorXd tau(1);
  const JointState rest = stateOf(vec({1.0}), vec({0.0}));
  EXPECT_EQ(law.update(rest, vec({0.3}), kPeriod, tau), Status::kOk);
  EXPECT_NEAR(tau[0], g + Pendulum::friction(0.3), kRounding);
  EXPECT_NEAR(torqueOf(law, 1.0, 0.0), g, kRounding);  // without one it is at rest
}

TEST(GravityCompensation, ANonPhysicalInertiaMatrixIsWelcome) {
  auto solver = Pendulum::make();
  solver->physical = false;
  GravityCompensation law(solver, unlimited(1));
  EXPECT_NEAR(torqueOf(law, 0.0, 0.0), 9.81, kRounding);
}

// H qdd = -rate H qd, also while a joint's velocity is lost: what moves brakes, and shakes nothing.
TEST(GravityCompensation, MotionsDecayAtTheRate) {
  const auto solver = ChainSolver::make(twoBars());
  LawOptions options = unlimited(2);
  options.damping = {};
  options.damping_rate = 5.0;
  GravityCompensation law(solver, options);
  const Eigen::VectorXd q = vec({0.3, -1.0}), qd = vec({0.5, -0.7});
  const auto acceleration = [&](const Eigen::VectorXd& tau) -> Eigen::VectorXd {
    return solver->getInertiaMatrix(q).inverse() * (tau - solver->getGravityVector(q));
  };
  Eigen::VectorXd tau(2);
  ASSERT_EQ(law.update(stateOf(q, qd), kPeriod, tau), Status::kOk);
  EXPECT_LT((acceleration(tau) + 5.0 * qd).norm(), kRounding);
  ASSERT_EQ(law.hold(stateOf(q, qd), kPeriod, tau), Status::kOk);
  EXPECT_LT((acceleration(tau) + 5.0 * qd).norm(), kRounding);
  ASSERT_EQ(law.update(stateOf(vec({kNan, -1.0}), vec({kNan, -0.7})), kPeriod, tau),
            Status::kStateNotFinite);
  EXPECT_LT((acceleration(tau) + 5.0 * vec({0.0, -0.7})).norm(), kRounding);
}

TEST(GravityCompensation, DampingChangesWhileTheLoopRuns) {
  LawOptions options = unlimited(1);
  options.friction.source = FrictionSource::kNone;
  GravityCompensation law(Pendulum::make(), options);
  const JointState state = stateOf(vec({0.7}), vec({0.5}));
  Eigen::VectorXd tau(1);
  EXPECT_TRUE(law.setDamping(vec({6.0}), 2.0));  // H = 0.5 kg m^2
  ASSERT_EQ(law.update(state, 1e-3, tau), Status::kOk);
  EXPECT_NEAR(tau[0], 9.81 * std::cos(0.7) - 7.0 * 0.5, kRounding);
  for (const Eigen::VectorXd& bad : {vec({-1.0}), vec({kNan}), vec({kInfinity}), vec({1.0, 2.0})}) {
    EXPECT_FALSE(law.setDamping(bad));
  }
  for (const double bad : {-1.0, kNan, kInfinity}) EXPECT_FALSE(law.setDamping(vec({1.0}), bad));
  ASSERT_EQ(law.hold(state, 1e-3, tau), Status::kOk);
  EXPECT_NEAR(tau[0], 9.81 * std::cos(0.7) - 7.0 * 0.5, kRounding);
}

}  // namespace inverse_dynamics_control::gravity_compensation_test
