// SPDX-License-Identifier: Apache-2.0

#include "gravity_from_imu.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>

namespace inverse_dynamics_ros {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Outcome = GravityFromImu::Outcome;
using Source = GravityFromImu::Source;
using sensor_msgs::msg::Imu;

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr double kTimeConstant = 0.1;  // s
constexpr double kRounding = 1e-12;
const Vector3d kUpright(0, 0, -9.81);

// The base, tilted by 30 degrees about its x axis; the IMU on it, turned by 90 degrees about z.
const Matrix3d kBase = Eigen::AngleAxisd(M_PI / 6, Vector3d::UnitX()).toRotationMatrix();
const Matrix3d kMount = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
const Vector3d kTilted = kBase.transpose() * kUpright;

// What the IMU says of a base that accelerates (in its own axes).
Imu messageOf(const Vector3d& acceleration = Vector3d::Zero()) {
  Imu message;
  const Vector3d shown = kMount.transpose() * (acceleration - kTilted);
  message.linear_acceleration.x = shown.x();
  message.linear_acceleration.y = shown.y();
  message.linear_acceleration.z = shown.z();
  const Eigen::Quaterniond orientation(kBase * kMount);
  message.orientation.w = orientation.w();
  message.orientation.x = orientation.x();
  message.orientation.y = orientation.y();
  message.orientation.z = orientation.z();
  return message;
}

GravityFromImu make(Source source) { return {source, kMount, kTimeConstant, kUpright}; }

TEST(GravityFromImu, IsReachedWithTheTimeConstant) {
  for (const Source source : {Source::kAcceleration, Source::kOrientation}) {
    GravityFromImu imu = make(source);
    EXPECT_EQ(imu.gravity(), kUpright);
    for (int k = 0; k <= 100; ++k) {
      ASSERT_EQ(imu.update(messageOf(), k * kMillisecond), Outcome::kTaken);
    }
    const Vector3d expected = kTilted + std::exp(-1.0) * (kUpright - kTilted);
    EXPECT_LT((imu.gravity() - expected).norm(), kRounding);
    for (int k = 101; k <= 5000; ++k) {
      imu.update(messageOf(), k * kMillisecond);
    }
    EXPECT_LT((imu.gravity() - kTilted).norm(), kRounding);
  }
}

TEST(GravityFromImu, AnAcceleratingBaseIsSeenByTheAccelerometerAlone) {
  const Vector3d acceleration(1, 2, 3);
  GravityFromImu both = make(Source::kAcceleration), tilt = make(Source::kOrientation);
  for (int k = 0; k <= 5000; ++k) {
    both.update(messageOf(acceleration), k * kMillisecond);
    tilt.update(messageOf(acceleration), k * kMillisecond);
  }
  EXPECT_LT((both.gravity() - (kTilted - acceleration)).norm(), kRounding);
  EXPECT_LT((tilt.gravity() - kTilted).norm(), kRounding);
}

TEST(GravityFromImu, NeverJumps) {
  GravityFromImu imu = make(Source::kAcceleration);
  EXPECT_EQ(imu.update(messageOf(), 1000 * kMillisecond), Outcome::kTaken);
  EXPECT_EQ(imu.gravity(), kUpright) << "the first message has no time";
  imu.update(messageOf(), 10 * kMillisecond);
  EXPECT_EQ(imu.gravity(), kUpright) << "the clock went back";
  imu.update(messageOf(), 1'000'000 * kMillisecond);
  const Vector3d expected = kTilted + std::exp(-1.0) * (kUpright - kTilted);
  EXPECT_LT((imu.gravity() - expected).norm(), kRounding) << "a pause";
}

TEST(GravityFromImu, WhatCannotBeUsedIsLeftOut) {
  GravityFromImu by_acceleration = make(Source::kAcceleration);
  GravityFromImu by_orientation = make(Source::kOrientation);
  by_acceleration.update(messageOf(), 0);
  by_orientation.update(messageOf(), 0);
  Imu message = messageOf();
  message.linear_acceleration.y = std::numeric_limits<double>::quiet_NaN();
  message.orientation.w *= 1.1;
  EXPECT_EQ(by_acceleration.update(message, kMillisecond), Outcome::kNotFinite);
  EXPECT_EQ(by_orientation.update(message, kMillisecond), Outcome::kNotFinite);
  message.orientation = geometry_msgs::msg::Quaternion();
  message.orientation.w = 0;
  EXPECT_EQ(by_orientation.update(message, kMillisecond), Outcome::kNotFinite);
  message = messageOf();
  message.linear_acceleration_covariance[0] = message.orientation_covariance[0] = -1;
  EXPECT_EQ(by_acceleration.update(message, kMillisecond), Outcome::kAbsent);
  EXPECT_EQ(by_orientation.update(message, kMillisecond), Outcome::kAbsent);
  EXPECT_EQ(by_acceleration.gravity(), kUpright);
  EXPECT_EQ(by_orientation.gravity(), kUpright);
}

}  // namespace
}  // namespace inverse_dynamics_ros
