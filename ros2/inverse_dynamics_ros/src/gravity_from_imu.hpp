// SPDX-License-Identifier: Apache-2.0

/// @file
/// Gravity in the axes of the root link, from an IMU that is fixed to it.

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <sensor_msgs/msg/imu.hpp>

namespace inverse_dynamics_ros {

/// Low-passed gravity of IMU messages as they come.
class GravityFromImu {
 public:
  /// Which field of the message it is taken from.
  enum class Source {
    kAcceleration,  ///< linear_acceleration: what an accelerometer shows, acceleration less gravity
    kOrientation,   ///< orientation, relative to a frame whose z axis points up
  };

  /// Outcome of a message.
  enum class Outcome {
    kTaken,
    kAbsent,     ///< its covariance begins with -1: the IMU doesn't measure it
    kNotFinite,  ///< it isn't finite, or the orientation isn't a unit quaternion: left out
  };

  /// @param R_root_imu     axes of the IMU in those of the root link.
  /// @param time_constant  of the low-pass, s, > 0.
  /// @param gravity        initial value; kOrientation keeps its norm; m/s^2.
  GravityFromImu(Source source, const Eigen::Matrix3d& R_root_imu, double time_constant,
                 const Eigen::Vector3d& gravity);

  /// Takes a message. @param stamp  ns. It never jumps: a pause counts as one time constant at most,
  /// a stamp that goes back as no time.
  Outcome update(const sensor_msgs::msg::Imu& message, std::int64_t stamp);

  /// m/s^2, axes of the root link. From kAcceleration less the acceleration of the root link.
  const Eigen::Vector3d& gravity() const { return gravity_; }

 private:
  Outcome read(const sensor_msgs::msg::Imu& message, Eigen::Vector3d& gravity) const;

  Source source_;
  Eigen::Matrix3d R_;
  double time_constant_, size_;  // s; m/s^2
  Eigen::Vector3d gravity_;
  bool started_ = false;
  std::int64_t stamp_ = 0;  // ns
};

}  // namespace inverse_dynamics_ros
