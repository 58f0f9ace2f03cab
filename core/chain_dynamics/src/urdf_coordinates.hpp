// SPDX-License-Identifier: Apache-2.0

/// @file
/// The coordinates of a mechanism of a robot description.

#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "follower.hpp"
#include "locked_joints.hpp"
#include "urdf_paths.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace paths {

/// Numbers the joints that move, and adds to a coordinate what its followers have.
class Coordinates {
 public:
  Coordinates(const RobotDescription& robot, const LockedJoints& locked)
      : robot_(robot), link_(robot.joints.size()), coordinate_(robot.joints.size()) {
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      if (!locked.onPath(j) || !locked.moves(j)) continue;
      link_[j] = links_++;
      if (!robot.joints[j].mimic) coordinate_[j] = coordinates_++;
    }
    joints_.resize(static_cast<std::size_t>(coordinates_));
  }

  Branch branch(const std::string& tip, Chain chain) const {
    Branch result{tip, std::move(chain), {}, {}, {}};
    for (Eigen::Index i = 0; i < result.chain.jointCount(); ++i) {
      const std::size_t j = indexOf(result.chain.joints()[static_cast<std::size_t>(i)]);
      const RobotDescription::Mimic leader = leaderOf(robot_, j);
      if (leader.multiplier != 0) {
        result.S.push_back({i, coordinate_[leader.joint], leader.multiplier});
      }
      result.s.push_back(leader.offset);
      result.link.push_back(link_[j]);
    }
    return result;
  }

  /// Joints that mimic no other one come first: call it for all branches with `follow` false, then true.
  void take(const Chain& branch, bool follow) {
    for (const Joint& joint : branch.joints()) {
      const RobotDescription::Mimic leader = leaderOf(robot_, indexOf(joint));
      if (robot_.joints[indexOf(joint)].mimic.has_value() != follow) continue;
      if (!taken_.insert(joint.name).second) continue;
      Joint& to = joints_[static_cast<std::size_t>(coordinate_[leader.joint])];
      if (follow) {
        const std::string doubt = addFollower(to, joint, leader.multiplier, leader.offset);
        if (!doubt.empty()) warnings_.push_back(doubt);
      } else {
        to = joint;
        to.placement = Transform<double>::identity();
      }
    }
  }

  Eigen::Index joints() const { return links_; }
  std::vector<std::string> warnings() const { return warnings_; }

  Chain chain(const Eigen::Vector3d& gravity) const {
    if (joints_.empty() || joints_.size() > kMostCoordinates ||
        links_ > static_cast<Eigen::Index>(kMostMovingJoints)) {
      throw ModelError(where(robot_), "joints between root and tips",
                       "1 to " + std::to_string(kMostMovingJoints) + ", of which 1 to " +
                           std::to_string(kMostCoordinates) + " mimic no other",
                       std::to_string(links_) + " and " + std::to_string(joints_.size()),
                       "name fewer tips, or hold joints at a position");
    }
    return {robot_.name, joints_,
            std::vector<LinkParameters>(joints_.size(), LinkParameters::zero()), gravity};
  }

 private:
  std::size_t indexOf(const Joint& joint) const { return robot_.jointIndex(joint.name); }

  const RobotDescription& robot_;
  std::vector<Eigen::Index> link_, coordinate_;  // of joints of the description
  Eigen::Index links_ = 0, coordinates_ = 0;
  std::vector<Joint> joints_;
  std::set<std::string> taken_;
  std::vector<std::string> warnings_;
};

}  // namespace paths
}  // namespace v2
}  // namespace chain_dynamics
