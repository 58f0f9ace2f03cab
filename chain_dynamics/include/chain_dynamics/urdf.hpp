// SPDX-License-Identifier: Apache-2.0

/// @file
/// A chain from a URDF robot description.
///
///     Chain arm = chainFromUrdf(urdf_xml);                             // root to leaf
///     Chain arm = chainFromUrdf(urdf_xml, {"base_link", "tool0"});     // a part of the robot
///     UrdfOptions options; options.gravity = {0, -9.81, 0};            // mounted on a wall
///
/// What becomes of a URDF:
///
/// - The chain's joints are the movable ones on the path from root to tip. Links joined by fixed
///   joints become one link: their parameters are moved into one frame and added.
/// - URDF joint axes are arbitrary, a chain's are z: where it isn't z already, the frame of the
/// link
///   is turned so that it is. Joint torques don't depend on how.
/// - Inertia before the first movable joint doesn't move, and so has no influence.
/// - What hangs on the chain beside the path or beyond the tip moves with it and is lumped into
///   the link it hangs on, unless `lump_attached` is false. Movable joints out there are held at
///   `locked_position`; one that mimics another follows it.
/// - `<dynamics damping friction>` becomes Joint::damping and Joint::friction, which no algorithm
///   reads (simulators disagree on its meaning).
/// - `<visual>`, `<collision>`, `<transmission>`, `<calibration>` and `<safety_controller>` aren't
///   read.
///
/// What URDF allows to be left out keeps URDF's meaning: no `<origin>` is the identity, no `<axis>`
/// is x, no `<inertial>` is no mass. Everything else that is missing, malformed or not a finite
/// number is an error that names line and joint or link.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Which part of a robot, and how it is taken.
struct UrdfOptions {
  /// Link the chain starts at; its frame is the root frame. Empty: the root of the URDF.
  std::string root = {};
  /// Link the chain ends at. Empty: the leaf below root; of several leaves that are moved by the
  /// same joints, the one with most joints (fixed ones too) above it. Leaves that differ in movable
  /// joints are ambiguous: an error. (A leaf moved by fewer of the same joints isn't one of them.)
  std::string tip = {};
  /// Where things fall, in the frame of root; m/s^2.
  Eigen::Vector3d gravity = {0, 0, -9.81};
  /// Whether what hangs on the chain beside the path or beyond the tip counts.
  bool lump_attached = true;
  /// Whether a movable body may be without mass and inertia (H is singular if nothing heavy is
  /// farther out).
  bool allow_massless = false;
  /// Position at which a movable joint beside the path or beyond the tip is held; rad, prismatic m.
  /// Empty: all at zero.
  std::function<double(const std::string& joint)> locked_position = {};
};

/// The chain from root to tip of a robot description.
///
/// @param urdf_xml  text of the URDF (not a file name); xacro must have been expanded.
/// @throws ModelError  naming line and joint or link: no URDF or a broken one, unknown root or
///     tip, tip not below root, several leaves, planar, floating or mimicking joint, zero axis,
///     missing, malformed or non-finite number, negative mass, movable body without mass. An
///     inertia that no rigid body can have gives one of Chain::warnings().
/// Threads: safe.
Chain chainFromUrdf(const std::string& urdf_xml, const UrdfOptions& options = {});

}  // namespace v2
}  // namespace chain_dynamics
