// SPDX-License-Identifier: Apache-2.0

#include "live_payload.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <regex>

#include "robot_parameters.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::VectorXd;
using inverse_dynamics_identification::PayloadEstimate;
using inverse_dynamics_identification::PayloadStatus;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Payload;
using inverse_dynamics_solver::RigidBody;
using inverse_dynamics_solver::conformance::AllocationGuard;

constexpr std::int64_t kPeriod = 4'000'000;  // ns

std::shared_ptr<InverseDynamicsSolver> ur10() {
  const NodeRobot robot(
      inverse_dynamics_solver::Parameters{{"robot", std::string("ur10_simulated")}});
  return robot.makeSolver(robot.description());
}

// The same arm without limits of position.
std::shared_ptr<InverseDynamicsSolver> turningUr10() {
  const NodeRobot robot(
      inverse_dynamics_solver::Parameters{{"robot", std::string("ur10_simulated")}});
  return robot.makeSolver(
      std::regex_replace(robot.description(), std::regex("\"revolute\""), "\"continuous\""));
}

RigidBody load(double mass) {
  RigidBody body;
  body.mass = mass;
  body.center_of_mass << 0.02, -0.03, 0.12;
  return body;
}

class LivePayloadTest : public testing::Test {
 protected:
  void SetUp() override { dynamic_cast<Payload&>(*loaded).setPayload("load", load(3.0)); }

  LivePayloadOptions options() const {
    LivePayloadOptions result;
    result.noise = VectorXd::Constant(6, 0.5);
    return result;
  }

  // The motion at a stamp, with the torques that it needs with the load.
  void moveTo(std::int64_t stamp) {
    const double t = 1e-9 * static_cast<double>(stamp);
    VectorXd qdd(6);
    for (Eigen::Index j = 0; j < 6; ++j) {
      const double w = 0.9 + 0.17 * static_cast<double>(j);
      q[j] = 0.7 * std::sin(w * t) + 0.4 * static_cast<double>(j) - 1.0;
      qd[j] = 0.7 * w * std::cos(w * t);
      qdd[j] = -0.7 * w * w * std::sin(w * t);
    }
    effort = loaded->getTorques(q, qd, qdd);
  }

  std::int64_t run(LivePayload& payload, double seconds, std::int64_t begin = 0) {
    std::int64_t stamp = begin;
    for (; stamp < begin + static_cast<std::int64_t>(1e9 * seconds); stamp += kPeriod) {
      moveTo(stamp);
      payload.update(stamp, q, qd, effort);
    }
    return stamp;
  }

  static void expectTheLoad(const PayloadEstimate& found) {
    EXPECT_NEAR(found.mass, 3.0, 0.03);
    EXPECT_LT((found.center_of_mass - load(3.0).center_of_mass).norm(), 0.01)
        << found.center_of_mass.transpose();
  }

  const std::shared_ptr<InverseDynamicsSolver> loaded = ur10(), solver = ur10();
  VectorXd q{6}, qd{6}, effort{6};
  PayloadEstimate found{6};
};

TEST_F(LivePayloadTest, IsTheLoadInSpiteOfTheFilter) {
  LivePayload payload(solver, options());
  EXPECT_EQ(payload.estimate(found), PayloadStatus::kTooShort);
  run(payload, 8.0);
  ASSERT_EQ(payload.estimate(found), PayloadStatus::kOk);
  expectTheLoad(found);
}

TEST_F(LivePayloadTest, PositionsWithinOneTurnGiveTheSame) {
  constexpr double kTurn = 6.283185307179586;
  LivePayload unbounded(turningUr10(), options()), within(turningUr10(), options());
  for (std::int64_t stamp = 0; stamp < 8'000'000'000; stamp += kPeriod) {
    moveTo(stamp);
    VectorXd reported = q;
    for (Eigen::Index j = 0; j < 6; ++j) {  // seams in the middle of the motion
      const double seam = 0.4 * static_cast<double>(j) - 1.0;
      reported[j] -= kTurn * std::floor((q[j] - seam) / kTurn);
    }
    unbounded.update(stamp, q, qd, effort);
    within.update(stamp, reported, qd, effort);
  }
  PayloadEstimate other(6);
  ASSERT_EQ(unbounded.estimate(found), PayloadStatus::kOk);
  ASSERT_EQ(within.estimate(other), PayloadStatus::kOk);
  expectTheLoad(found);
  EXPECT_NEAR(other.mass, found.mass, 1e-9);
  EXPECT_LT((other.center_of_mass - found.center_of_mass).norm(), 1e-9);
}

TEST_F(LivePayloadTest, HoldsWhatIsCarriedAlready) {
  dynamic_cast<Payload&>(*solver).setPayload("part of it", load(2.0));
  LivePayloadOptions with = options();
  with.carried = load(2.0);
  LivePayload payload(solver, with);
  run(payload, 8.0);
  ASSERT_EQ(payload.estimate(found), PayloadStatus::kOk);
  expectTheLoad(found);
}

TEST_F(LivePayloadTest, EffortsMayLackTheGravityOfTheArm) {
  LivePayloadOptions with = options();
  with.without_gravity = true;
  LivePayload payload(solver, with);
  for (std::int64_t stamp = 0; stamp < 8'000'000'000; stamp += kPeriod) {
    moveTo(stamp);
    payload.update(stamp, q, qd, effort - solver->getGravityVector(q));
  }
  ASSERT_EQ(payload.estimate(found), PayloadStatus::kOk);
  expectTheLoad(found);
}

TEST_F(LivePayloadTest, WhatCannotBeUsedIsLeftOut) {
  LivePayload payload(solver, options());
  const std::int64_t stamp = run(payload, 4.0);
  VectorXd broken = effort;
  broken[1] = std::numeric_limits<double>::quiet_NaN();
  payload.update(stamp, q, qd, broken);
  payload.update(stamp - kPeriod, q, qd, VectorXd(3.0 * effort));  // its stamp was there
  run(payload, 4.0, stamp + 600'000'000);                          // a gap
  ASSERT_EQ(payload.estimate(found), PayloadStatus::kOk);
  expectTheLoad(found);
}

TEST_F(LivePayloadTest, AClockThatGoesBackBeginsAgain) {
  LivePayload payload(solver, options());
  run(payload, 8.0, 100'000'000'000);
  run(payload, 1.0);
  EXPECT_EQ(payload.estimate(found), PayloadStatus::kTooShort);
  run(payload, 8.0, 1'000'000'000);
  ASSERT_EQ(payload.estimate(found), PayloadStatus::kOk);
  expectTheLoad(found);
}

TEST_F(LivePayloadTest, NoiseMustBeThatOfEachJoint) {
  LivePayloadOptions wrong = options();
  wrong.noise.resize(5);
  wrong.noise.setConstant(1.0);
  EXPECT_THROW(LivePayload(solver, wrong), inverse_dynamics_solver::InvalidParameterValueException);
}

TEST_F(LivePayloadTest, AllocatesNothing) {
  if (!inverse_dynamics_solver::conformance::kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations can't be counted here";
  }
  LivePayloadOptions without_gravity = options();
  without_gravity.without_gravity = true;
  LivePayload payload(solver, without_gravity);
  const std::int64_t stamp = run(payload, 3.0);
  moveTo(stamp);
  const AllocationGuard guard;
  payload.update(stamp, q, qd, effort);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace inverse_dynamics_ros
