// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/joint_frame.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace chain_dynamics {
inline namespace v2 {

Matrix3<double> rotationFromZ(const Vector3<double>& axis) {
  // below the horizon, turn about x by pi first: the formula that follows fails near -z
  if (axis.z() < 0) {
    const Vector3<double> flip(1, -1, -1);
    return flip.asDiagonal() * rotationFromZ(flip.asDiagonal() * axis);
  }

  // R = 1 + [v]x + [v]x [v]x / (1 + cos), v = z x axis
  const Matrix3<double> v_x = skew<double>(Vector3<double>::UnitZ().cross(axis));
  return Matrix3<double>::Identity() + v_x + v_x * v_x / (1 + axis.z());
}

Matrix3<double> rotationFromRollPitchYaw(const Vector3<double>& rpy) {
  using Eigen::AngleAxisd;
  const Vector3<double> x = Vector3<double>::UnitX();
  const Vector3<double> y = Vector3<double>::UnitY();
  const Vector3<double> z = Vector3<double>::UnitZ();
  return (AngleAxisd(rpy.z(), z) * AngleAxisd(rpy.y(), y) * AngleAxisd(rpy.x(), x))
      .toRotationMatrix();
}

Vector3<double> rollPitchYaw(const Matrix3<double>& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  // of RotZ(yaw)' R: exact for any yaw where the pitch is near a right angle
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

LinkParameters symmetric(const LinkParameters& link) {
  return {link.mass, link.first_moment, 0.5 * (link.inertia + link.inertia.transpose())};
}

}  // namespace v2
}  // namespace chain_dynamics
