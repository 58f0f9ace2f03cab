// SPDX-License-Identifier: Apache-2.0

/// @file
/// The joints of a model file, each with the link that it moves.

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/located_yaml.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

enum class Geometry { kModifiedDH, kStandardDH, kPlacements };
enum class Parameters { kAboutOrigin, kAboutCenterOfMass };
enum class Level { kTorque, kCurrent };

/// What the head of a file says about its joints.
struct Conventions {
  int schema = 1;
  Geometry geometry;
  Parameters parameters;
  bool tree = false;   // whether `tips` are there, and joints may have parents and mimic
  bool gains = false;  // whether `levels` is there, and so every joint has a drive gain
  Level parameters_level = Level::kTorque;
  Level friction_level = Level::kTorque;
};

/// A joint that another one follows.
struct MimicEntry {
  std::string joint;
  double multiplier = 1;
};

/// Friction at a place beside the joints.
struct FrictionPlace {
  std::string where, name;
  FrictionLaw law;
  std::vector<double> coupling;  // n
};

/// One joint of a file, with the link it moves. The file's link frame is U, the chain's is E.
struct JointEntry {
  std::string where;  // file, line and name, as error texts begin
  Joint joint;        // placement: E in the previous link's U
  Transform<double> X_EU = Transform<double>::identity();  // differs from link to link
  std::vector<LinkParameters> own;                         // in U: one set, or none
  std::vector<LinkParameters> row;                         // in U: n links, or none
  std::vector<Eigen::Vector3d> gravity_first_moment;       // in U: one, or none
  std::vector<FrictionLaw> friction;                       // one, or none
  std::vector<double> coupling;                            // n, or none: a motor of its own
  std::vector<double> drive_gain;                          // one, or none
  double stiffness = 0, rest = 0;                          // of a spring
  double lever_sin = 0, lever_cos = 0;                     // of one that pulls a lever
  std::vector<double> torque_deviation;                    // one, or none
  std::vector<SeenRange> seen;                             // one, or none
  std::string parent;              // of a tree: the joint that moves the link it is on; empty: none
  bool is_motor = false;           // which moves no link of its own
  std::vector<MimicEntry> mimics;  // none: it is a coordinate
  double offset = 0;               // where it stands if these stand at zero; rad; m
};

/// The joints; of a chain from root to tip. What one has of row, friction and so on, all have that mimic no
/// other.
std::vector<JointEntry> readJoints(const LocatedValue& value, const Conventions& conventions);

/// @param coordinates  those of coordinatesOf().
std::vector<FrictionPlace> readFrictionPlaces(const LocatedValue& value,
                                              const Conventions& conventions,
                                              const std::vector<JointEntry>& coordinates);

/// Those that mimic no other.
std::vector<JointEntry> coordinatesOf(const std::vector<JointEntry>& entries);

Eigen::Vector3d readVector(const LocatedValue& value);

/// The keys `xyz` [m] and `rpy` [rad].
Transform<double> readPose(LocatedMap& map);

}  // namespace v2
}  // namespace chain_dynamics
