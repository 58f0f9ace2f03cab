// SPDX-License-Identifier: Apache-2.0

/// @file
/// Ways through a robot description: paths between links, leaves below a link, whom a joint follows.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/urdf.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace paths {

using Joints = std::vector<std::size_t>;

constexpr std::size_t kNone = RobotDescription::kNone;

/// A joint on the way from root to tip, passed from its parent link to its child, or up.
struct Step {
  std::size_t joint = kNone;
  bool up = false;
};
using Path = std::vector<Step>;

/// Of errors.
std::string where(const RobotDescription& robot);
std::string where(const RobotDescription::Joint& joint);

/// The link of that name; an unknown name is answered by the nearest known ones.
std::size_t linkNamed(const RobotDescription& robot, const std::string& name,
                      const std::string& role);

/// The root of the chain or mechanism.
std::size_t rootOf(const RobotDescription& robot, const UrdfOptions& options);

/// The joints between the root of the robot and a link, the link's own first.
Joints jointsAbove(const RobotDescription& robot, std::size_t link);

/// Up from root to the first link that is above both, then down to tip.
Path pathBetween(const RobotDescription& robot, std::size_t root, std::size_t tip);

/// The one leaf below root that all movable joints lead to.
std::size_t leafBelow(const RobotDescription& robot, std::size_t root);

/// The links that mechanismFromRobot() calls tips.
std::vector<std::size_t> tipLinks(const RobotDescription& robot, const UrdfOptions& options,
                                  std::size_t root, const std::vector<std::string>& tips);

/// Which joint a joint follows in the end, through others, and how: itself if it mimics none.
RobotDescription::Mimic leaderOf(const RobotDescription& robot, std::size_t joint);

}  // namespace paths
}  // namespace v2
}  // namespace chain_dynamics
