// SPDX-License-Identifier: Apache-2.0

#include "gravity_from_imu.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sensor_msgs/msg/imu.hpp>

namespace inverse_dynamics_ros {
namespace {

constexpr double kUnit = 1e-2;  // how far the norm of a quaternion may be from 1

}  // namespace

GravityFromImu::GravityFromImu(Source source, const Eigen::Matrix3d& R_root_imu,
                               double time_constant, const Eigen::Vector3d& gravity)
    : source_(source),
      R_(R_root_imu),
      time_constant_(time_constant),
      size_(gravity.norm()),
      gravity_(gravity) {}

GravityFromImu::Outcome GravityFromImu::update(const sensor_msgs::msg::Imu& message,
                                               std::int64_t stamp) {
  Eigen::Vector3d gravity;
  const Outcome outcome = read(message, gravity);
  if (outcome != Outcome::kTaken) return outcome;
  const double passed = started_ ? 1e-9 * static_cast<double>(stamp - stamp_) : 0.0;
  const double period = std::clamp(passed, 0.0, time_constant_);
  gravity_ -= std::expm1(-period / time_constant_) * (R_ * gravity - gravity_);
  started_ = true;
  stamp_ = stamp;
  return Outcome::kTaken;
}

// In the axes of the IMU.
GravityFromImu::Outcome GravityFromImu::read(const sensor_msgs::msg::Imu& message,
                                             Eigen::Vector3d& gravity) const {
  if (source_ == Source::kAcceleration) {
    if (message.linear_acceleration_covariance[0] == -1) return Outcome::kAbsent;
    const auto& a = message.linear_acceleration;
    gravity << -a.x, -a.y, -a.z;
  } else {
    if (message.orientation_covariance[0] == -1) return Outcome::kAbsent;
    const auto& o = message.orientation;
    const Eigen::Quaterniond R_world_imu(o.w, o.x, o.y, o.z);
    if (!(std::abs(R_world_imu.norm() - 1) < kUnit)) return Outcome::kNotFinite;
    gravity = R_world_imu.normalized().conjugate() * Eigen::Vector3d(0, 0, -size_);
  }
  return gravity.allFinite() ? Outcome::kTaken : Outcome::kNotFinite;
}

}  // namespace inverse_dynamics_ros
