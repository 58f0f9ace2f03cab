// SPDX-License-Identifier: Apache-2.0

/// @file
/// A chain in the frames and with the few parameters that robot.hpp describes.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "robot.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {

/// The frames of a chain, turned about and moved along the axes that its own frames have.
struct Frames {
  std::vector<Placement> placements;
  std::vector<double> quarter_turns;     ///< of each joint's offset
  bool general_offsets = false;          ///< an offset has more than quarter turns
  Eigen::Vector3d root;                  ///< minus gravity in the frame of the first joint at q = 0
  std::vector<Transform<double>> moved;  ///< pose of the chain's own frame i in frame i
};

/// Frames with x along the common normals. Angles within 1e-13 of a quarter turn and lengths below
/// 1e-14 of those from there to the tip are rounded: more would be seen in the tenth digit of a
/// torque. Where the root's own placement is makes no difference.
Frames framesOf(const Chain& chain);

/// The parameters that torques depend on, from those of the links in the chain's own frames.
///
/// What turns about z without changing (mass, its moment and second moment along the axis), or
/// slides along z without changing (the second moment), is moved to the parent link.
std::vector<Body> regrouped(const Frames& frames, const std::vector<LinkParameters>& links);

/// The chain's own frames, with the angles of the new ones: each is turned back by the offset.
std::vector<OwnPlacement> ownPlacements(const Frames& frames, const Chain& chain);

/// The first frame at angle zero in the root frame, and the tip in the last frame.
FixedPose baseOf(const Frames& frames, const Chain& chain);
FixedPose tipOf(const Frames& frames, const Chain& chain);

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
