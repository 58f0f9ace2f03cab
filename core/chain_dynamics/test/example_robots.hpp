// SPDX-License-Identifier: Apache-2.0

/// @file
/// Robots small enough to work out by hand.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics::test {

/// Rounding of a handful of operations, relative to the numbers.
constexpr double kByHand = 1e-14;

/// A point mass, at a place of its link's frame.
inline LinkParameters pointMass(double mass, const Eigen::Vector3d& at) {
  return LinkParameters::fromCenterOfMass(mass, at, Eigen::Matrix3d::Zero());
}

/// A pose without rotation.
inline Transform<double> shiftedBy(const Eigen::Vector3d& p) {
  return {Eigen::Matrix3d::Identity(), p};
}

/// A point mass m on a massless rod of length l, turning about the horizontal z axis of the root.
/// x points to the side, y up: at q = 0 the rod is horizontal, and gravity pulls along -y.
inline Chain pendulum(double m, double l, double gravity, double rotor_inertia = 0) {
  Joint joint;
  joint.name = "pivot";
  joint.rotor_inertia = rotor_inertia;
  return Chain("pendulum", {joint}, {pointMass(m, {l, 0, 0})}, {0, -gravity, 0});
}

/// Two pendulums, the second hung on the end of the first.
inline Chain doublePendulum(double m1, double l1, double m2, double l2, double gravity) {
  Joint shoulder;
  shoulder.name = "shoulder";
  Joint elbow;
  elbow.name = "elbow";
  elbow.placement = shiftedBy({l1, 0, 0});
  return Chain("double_pendulum", {shoulder, elbow},
               {pointMass(m1, {l1, 0, 0}), pointMass(m2, {l2, 0, 0})}, {0, -gravity, 0});
}

/// A turntable about the vertical with a mass that slides along a radius: polar coordinates.
inline Chain turntable(double m) {
  Joint table;
  table.name = "table";
  Joint slide;
  slide.name = "slide";
  slide.type = JointType::kPrismatic;
  // turned so that the slide's z axis lies along the table's x axis
  slide.placement.R = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitY()).matrix();
  return Chain("turntable", {table, slide}, {LinkParameters::zero(), pointMass(m, {0, 0, 0})},
               {0, 0, -9.81});
}

}  // namespace chain_dynamics::test
