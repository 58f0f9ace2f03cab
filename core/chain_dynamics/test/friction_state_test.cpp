// SPDX-License-Identifier: Apache-2.0
#include "chain_dynamics/friction_state.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics::friction_state_test {

using Eigen::VectorXd;

constexpr double kHeight = 3, kDistance = 0.04, kWidth = 0.1;
constexpr double kPlay = 5e-5;
constexpr double kRounding = 1e-13;

/// Joints side by side whose friction preslides.
Model model(int joints = 1, JointType type = JointType::kRevolute) {
  std::vector<Joint> turning(static_cast<std::size_t>(joints));
  for (Joint& joint : turning) {
    joint.name = "joint" + std::to_string(&joint - turning.data());
    joint.type = type;
  }
  const LinkParameters link = LinkParameters::fromVector(
      (Eigen::Matrix<double, 10, 1>() << 1, 0, 0, 0, 0.1, 0, 0, 0.1, 0, 0.1).finished());
  Model model(Chain("arm", turning, std::vector<LinkParameters>(turning.size(), link),
                    Eigen::Vector3d(0, 0, -9.81)));
  SmoothCoulomb law;
  law.fc = 1;
  law.width = kWidth;
  law.fm = kHeight;
  law.distance = kDistance;
  model.friction.assign(static_cast<std::size_t>(joints), law);
  checkModel(model);
  return model;
}

/// What a state adds to the first joint at rest.
double atRest(const FrictionState& state, Eigen::Index joints = 1) {
  VectorXd f = VectorXd::Zero(joints);
  state.addTo(VectorXd::Zero(joints), f);
  return f[0];
}

void move(FrictionState& state, double q) { state.move(VectorXd::Constant(1, q)); }

TEST(FrictionState, FollowsDahlsEquation) {
  FrictionState state(model());
  move(state, 0);
  double z = 0, q = 0, s = 0;
  const auto go = [&](double to) {
    constexpr int kSteps = 200'000;
    const double dq = (to - q) / kSteps;
    for (int k = 0; k < kSteps; ++k) {  // midpoints: an independent integration
      q += dq;
      const double ds = std::clamp(s, q - kPlay, q + kPlay) - s;
      s += ds;
      const double sign = ds > 0 ? 1 : -1;
      const double half = z + 0.5 * (sign - z) * std::abs(ds) / kDistance;
      z += (sign - half) * std::abs(ds) / kDistance;
    }
    move(state, to);
    EXPECT_NEAR(atRest(state), kHeight * z, 1e-9) << to;
  };
  for (const double to : {0.01, 0.3, 0.28, 0.29, -1.0, -0.99}) go(to);
}

TEST(FrictionState, ItDoesNotMatterHowManyStepsAMonotoneMotionHas) {
  FrictionState one(model()), many(model());
  move(one, 0);
  move(one, 0.07);
  for (int k = 0; k <= 7; ++k) move(many, 0.01 * k);
  EXPECT_NEAR(atRest(one), atRest(many), kRounding);
}

TEST(FrictionState, StandingStillChangesNothing) {
  FrictionState state(model());
  move(state, 0);
  move(state, 0.03);
  const double before = atRest(state);
  for (int k = 0; k < 10'000; ++k) move(state, 0.03);
  EXPECT_EQ(atRest(state), before);
}

TEST(FrictionState, TheLastDigitOfAnEncoderWearsNothingOff) {
  FrictionState state(model());
  move(state, 0);
  move(state, 0.03);
  move(state, 0.03 - kPlay);
  const double before = atRest(state);
  for (int k = 0; k < 10'000; ++k) move(state, 0.03 - (k % 2) * 1.9 * kPlay);
  EXPECT_NEAR(atRest(state), before, kRounding);
}

TEST(FrictionState, WithoutKnowledgeItIsTheLimitWithinABand) {
  FrictionState state(model());
  VectorXd f = VectorXd::Zero(1), band = VectorXd::Zero(1);
  state.move(VectorXd::Zero(1));
  state.addTo(VectorXd::Constant(1, 0.5), f);
  EXPECT_EQ(f[0], 0);
  state.addUnknown(band);
  EXPECT_DOUBLE_EQ(band[0], kHeight);
  move(state, 20 * kDistance);
  band.setZero();
  state.addUnknown(band);
  EXPECT_LT(band[0], 1e-8);
  f.setZero();
  state.addTo(VectorXd::Constant(1, 10.0), f);  // far from rest both are whole
  EXPECT_NEAR(f[0], 0, 1e-8);
  state.reset();
  EXPECT_EQ(atRest(state), 0);
}

TEST(FrictionState, StartsAnywhereWithinItsBand) {
  for (const double z0 : {-1.0, -0.3, 1.0}) {
    FrictionState state(model());
    double q = 0, z = z0;
    move(state, q);
    for (const double by : {0.01, -0.02, 0.005}) {
      const double sign = by > 0 ? 1 : -1;
      z = sign + (z - sign) * std::exp(-std::abs(by) / kDistance);
      move(state, q += by);
      VectorXd band = VectorXd::Zero(1);
      state.addUnknown(band);
      EXPECT_LE(std::abs(kHeight * z - atRest(state)), band[0] + kRounding);
    }
  }
}

TEST(FrictionState, RangeEndsAtTheFrictionOfJointsThatCameFromOneSide) {
  constexpr double kFar = 40 * kDistance;
  Model coupled = model(2);
  coupled.coupling = (Eigen::MatrixXd(2, 2) << 1, 0, -1, 1).finished();
  const Eigen::Vector2d start(0.1, 0.2), qd(0.05, -0.1);
  FrictionState unknown(coupled);
  // Of the first joint both motors matter: the one that turns with it, and the one that turns against it.
  FrictionState least(coupled), most(coupled);
  for (const double from : {kFar, -kPlay}) {  // and to the middle of the play
    least.move(start + Eigen::Vector2d(from, 0));
    most.move(start - Eigen::Vector2d(from, 0));
  }
  for (const double by : {0.0, 0.01, -0.02, 0.005}) {
    const Eigen::Vector2d q = start + by * Eigen::Vector2d(1, 3);
    VectorXd low = VectorXd::Zero(2), high = low, from_above = low, from_below = low;
    for (FrictionState* const state : {&unknown, &least, &most}) state->move(q);
    unknown.addRange(qd, low, high);
    least.addTo(qd, from_above);
    most.addTo(qd, from_below);
    EXPECT_NEAR(low[0], from_above[0], kRounding) << by;
    EXPECT_NEAR(high[0], from_below[0], kRounding) << by;
    EXPECT_LE(low[1], std::min(from_above[1], from_below[1]) + kRounding) << by;
    EXPECT_GE(high[1], std::max(from_above[1], from_below[1]) - kRounding) << by;
  }
}

TEST(FrictionState, WholeTurnsOfContinuousJointsAreNoMotion) {
  FrictionState turned(model(1, JointType::kContinuous)), plain(model());
  for (const double q : {0.0, 0.02, 0.05}) {
    move(turned, q + (q > 0.03 ? 8 * std::acos(0.0) : 0));
    move(plain, q);
  }
  EXPECT_NEAR(atRest(turned), atRest(plain), kRounding);
}

TEST(FrictionState, ActsAtMotors) {
  Model coupled = model(2);
  coupled.coupling = (Eigen::MatrixXd(2, 2) << 1, 0, -1, 1).finished();
  FrictionState state(coupled);
  state.move(VectorXd::Zero(2));
  state.move(VectorXd::Constant(2, 1.0));  // the second motor stands still
  VectorXd f = VectorXd::Zero(2);
  state.addTo(VectorXd::Zero(2), f);
  EXPECT_NEAR(f[0], kHeight, 1e-9);
  EXPECT_NEAR(f[1], 0, 1e-9);
  state.move(Eigen::Vector2d(1, 2));
  f.setZero();
  state.addTo(VectorXd::Zero(2), f);
  EXPECT_NEAR(f[0], 0, 1e-9);  // C' (1, 1) fm
  EXPECT_NEAR(f[1], kHeight, 1e-9);
}

TEST(FrictionState, OfManyStatesIsThatOfEach) {
  FrictionState each(model()), many(model());
  const Eigen::MatrixXd q = (Eigen::MatrixXd(1, 5) << 0, 0.02, 0.05, 0.03, 0.03).finished();
  const Eigen::MatrixXd qd = (Eigen::MatrixXd(1, 5) << 0.1, 0.3, 0, -0.2, 0).finished();
  Eigen::MatrixXd f = Eigen::MatrixXd::Ones(1, 5);
  many.addAlong(q, qd, f);
  for (Eigen::Index k = 0; k < 5; ++k) {
    VectorXd one = VectorXd::Ones(1);
    each.move(q.col(k));
    each.addTo(qd.col(k), one);
    EXPECT_EQ(one[0], f(0, k));
  }
}

TEST(FrictionState, LeavesOutPositionsThatAreNotFinite) {
  FrictionState state(model());
  move(state, 0);
  move(state, 0.02);
  const double before = atRest(state);
  move(state, std::numeric_limits<double>::quiet_NaN());
  move(state, std::numeric_limits<double>::infinity());
  EXPECT_EQ(atRest(state), before);
  move(state, 0.03);
  EXPECT_GT(atRest(state), before);
}

TEST(FrictionState, WhatFallsWithVelocityLagsToo) {
  Model falling = model();
  auto& law = std::get<SmoothCoulomb>(falling.friction[0]);
  law.fm = 0;
  law.fs = 2;
  law.vs = 0.5;
  FrictionState state(falling);
  move(state, 0);
  move(state, 20 * kDistance);
  EXPECT_NEAR(atRest(state), 2, 1e-6);
  VectorXd f = VectorXd::Zero(1);
  state.addTo(VectorXd::Constant(1, -0.5), f);  // z is still 1, and the limit has turned round
  EXPECT_NEAR(f[0], 2 * std::exp(-1) * (1 + std::tanh(0.5 / kWidth)), 1e-6);
}

TEST(FrictionState, OfOtherLawsRemembersNothing) {
  Model other = model();
  other.friction[0] = ViscousCoulombOffset{1, 1, 0};
  FrictionState state(other);
  EXPECT_FALSE(state.remembers());
  move(state, 0);
  move(state, 1);
  EXPECT_EQ(atRest(state), 0);
}

}  // namespace chain_dynamics::friction_state_test
