// SPDX-License-Identifier: Apache-2.0

/// @file
/// A chain from a URDF robot description.
///
///     Chain robot = chainFromUrdf(urdf_xml);                           // root to leaf
///     Chain arm = chainFromUrdf(urdf_xml, {"base_link", "tool0"});     // a part of the robot
///     Chain back = chainFromUrdf(urdf_xml, {"tool0", "base_link"});    // held by its tool
///     UrdfOptions options; options.gravity = {0, -9.81, 0};            // mounted on a wall
///
/// What becomes of a URDF, read as in robot_description.hpp:
///
/// - Root and tip are any two links. The path goes up the tree to the first link above both and
///   down again, as that of KDL's Tree::getChain; the chain's joints are the movable ones on it.
/// - A joint that is passed from child to parent keeps the sign of its position, velocity and
///   torque: the chain moves its parent link, with that link's own inertia, about the opposite
///   axis.
/// - Links joined by fixed joints become one link: their parameters are moved into one frame and
///   added.
/// - URDF joint axes are arbitrary, a chain's are z: where it isn't z already, the link's frame is
///   turned so that it is. Joint torques don't depend on how.
/// - The root link is held: inertia before the first movable joint has no influence.
/// - Bodies attached to the chain beside the path, beyond the tip or, where the path turns, above
///   it move with it and are lumped into the link that carries them, unless `lump_attached` is
///   false. Movable joints among them are held at `locked_position`; one that mimics another
///   follows it. A floating joint above the path attaches nothing: what is above it is the world.
/// - `<dynamics damping friction>` becomes Joint::damping and Joint::friction, which no algorithm
///   reads (simulators disagree on its meaning).
///
/// Chain::warnings() holds RobotDescription::warnings, a default gravity that the description's
/// mounting contradicts, a tip above the root, the locked positions that had no influence or are
/// beyond a joint's limits, and the links whose inertia no rigid body can have, is implausible (wrong
/// units), or is missing before links with mass.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/robot_description.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Which part of a robot, and how it is taken.
struct UrdfOptions {
  /// Link the chain starts at; its frame is the root frame. Empty: the root of the URDF.
  std::string root = {};
  /// Link the chain ends at; its frame is the tip frame. Empty: the leaf below root; of several
  /// leaves that are moved by the same joints, the one with most joints (fixed ones too) above it.
  /// Leaves that differ in movable joints are ambiguous: an error. (A leaf moved by fewer of the
  /// same joints isn't one of them.)
  std::string tip = {};
  /// Gravitational acceleration, in the frame of root; m/s^2. Nothing: (0, 0, -9.81), and a warning
  /// where that isn't down the z axis of the description's root (joints between them at zero).
  std::optional<Eigen::Vector3d> gravity = {};
  /// Whether bodies attached beside the path, beyond the tip or above the path are included.
  bool lump_attached = true;
  /// Whether a movable body may be without mass and inertia even where H isn't proved to be
  /// positive definite at every position. (Where it is, as within a joint of two crossing axes, it
  /// may be.)
  bool allow_massless = false;
  /// Position at which a movable joint is held; rad, prismatic m. It is asked for every joint of the
  /// robot; nothing: held at zero beside the path and beyond the tip. The chain lacks joints of the
  /// path that are held. A position without influence gives a warning.
  std::function<std::optional<double>(const std::string& joint)> locked_position = {};
  /// Rotor inertia of a joint of the chain, reflected to the joint; kg m^2, prismatic kg. It is
  /// asked for every joint of the chain, and may answer with what the description states. Empty:
  /// none.
  std::function<double(const RobotDescription::Joint& joint)> rotor_inertia = {};
};

/// The chain from root to tip of a robot description.
///
/// @param urdf_xml  text of the URDF (not a file name); xacro must have been expanded.
/// @throws ModelError  where robotFromUrdf() does, and naming joint or link: unknown root or tip,
///     several leaves, planar, floating or mimicking joint, movable body without mass.
/// Threads: safe.
Chain chainFromUrdf(const std::string& urdf_xml, const UrdfOptions& options = {});

/// The same of a description that has been read.
Chain chainFromRobot(const RobotDescription& robot, const UrdfOptions& options = {});

}  // namespace v2
}  // namespace chain_dynamics
