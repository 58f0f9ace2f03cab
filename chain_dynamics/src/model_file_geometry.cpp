// SPDX-License-Identifier: Apache-2.0

#include "model_file_geometry.hpp"

#include <cmath>
#include <string>

#include "joint_frame.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

/// Sine and cosine of an angle; exact for angles in quarter turns.
struct Angle {
  double sine;
  double cosine;
};

/// The key `name` [rad] or `name_quarter_turns` (right angles, without the rounding of pi / 2).
Angle angle(LocatedMap& map, const std::string& name) {
  const auto quarter_turns = map.optional(name + "_quarter_turns");
  if (!quarter_turns) {
    const double value = map.required(name).number();
    return {std::sin(value), std::cos(value)};
  }
  if (const auto both = map.optional(name)) {
    both->fail("either this key or " + name + "_quarter_turns");
  }
  constexpr double kSine[] = {0, 1, 0, -1};
  const std::int64_t turns = quarter_turns->integer() & 3;  // modulo 4, negative ones too
  return {kSine[turns], kSine[(turns + 1) & 3]};
}

Transform<double> turnAboutX(const Angle& a) {
  Matrix3<double> R;
  R << 1, 0, 0, 0, a.cosine, -a.sine, 0, a.sine, a.cosine;
  return {R, Eigen::Vector3d::Zero()};
}

Transform<double> turnAboutZ(const Angle& a) {
  Matrix3<double> R;
  R << a.cosine, -a.sine, 0, a.sine, a.cosine, 0, 0, 0, 1;
  return {R, Eigen::Vector3d::Zero()};
}

Transform<double> shift(double x, double y, double z) {
  return {Matrix3<double>::Identity(), Eigen::Vector3d(x, y, z)};
}

}  // namespace

Eigen::Vector3d readVector(const LocatedValue& value) {
  return Eigen::Vector3d(value.numbers(3).data());
}

JointGeometry readDH(LocatedMap map, Geometry geometry) {
  const double a = map.required("a").number();
  const double d = map.required("d").number();
  const auto X_alpha_a = turnAboutX(angle(map, "alpha")) * shift(a, 0, 0);
  const auto X_offset_d = turnAboutZ(angle(map, "offset")) * shift(0, 0, d);
  map.rejectOthers();
  if (geometry == Geometry::kModifiedDH) {
    return {X_alpha_a * X_offset_d, Transform<double>::identity()};
  }
  return {X_offset_d, X_alpha_a};
}

Transform<double> readPose(LocatedMap& map) {
  const Eigen::Vector3d xyz = readVector(map.required("xyz"));
  return {rotationFromRollPitchYaw(readVector(map.required("rpy"))), xyz};
}

JointGeometry readPlacement(LocatedMap map) {
  const Transform<double> X = readPose(map);
  const LocatedValue axis = map.required("axis");
  map.rejectOthers();
  const Eigen::Vector3d direction = readVector(axis);
  if (direction.isZero(0)) {
    axis.fail("a direction", "the zero vector has none; for example [0, 0, 1]");
  }
  const Matrix3<double> R_UE = rotationFromZ(direction.stableNormalized());
  return {{X.R * R_UE, X.p}, {R_UE.transpose(), Eigen::Vector3d::Zero()}};
}

}  // namespace v2
}  // namespace chain_dynamics
