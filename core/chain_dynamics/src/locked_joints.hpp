// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joints of a robot description that are held.

#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/text.hpp"
#include "chain_dynamics/urdf.hpp"
#include "plausibility.hpp"
#include "urdf_paths.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace paths {

/// Where joints are held: those beside the paths and beyond the tips, and those on them whose position is
/// given.
class LockedJoints {
 public:
  LockedJoints(const RobotDescription& robot, const UrdfOptions& options,
               const std::vector<Path>& paths)
      : robot_(robot), on_path_(robot.joints.size(), false), used_(on_path_) {
    for (const Path& path : paths) {
      for (const Step& step : path) on_path_[step.joint] = true;
    }
    given_.resize(robot.joints.size());
    for (std::size_t j = 0; j < given_.size() && options.locked_position; ++j) {
      given_[j] = options.locked_position(robot.joints[j].name);
    }
    position_.resize(robot.joints.size());
  }

  bool onPath(std::size_t j) const { return on_path_[j]; }

  /// Whether the chain moves a joint of the path. One that mimics a joint that is held is held, too.
  bool moves(std::size_t j) const {
    const std::size_t leader = leaderOf(robot_, j).joint;
    return movesItself(j) && (leader == j || movesItself(leader));
  }

  /// Refuses a joint that follows one which moves, but isn't on a path.
  void checkLeader(std::size_t j) const {
    const std::size_t leader = leaderOf(robot_, j).joint;
    if (!movesItself(j) || !movesItself(leader) || onPath(leader)) return;
    throw ModelError(where(robot_.joints[j]), "<mimic>",
                     "a joint that follows one between root and tips",
                     "one that follows joint " + robot_.joints[leader].name,
                     "add a tip beyond that joint, or hold it at a position");
  }

  /// Where a joint that is held has moved its link.
  Transform<double> motion(std::size_t j) {
    const RobotDescription::Joint& joint = robot_.joints[j];
    auto X = Transform<double>::identity();
    if (!isMovable(joint)) return X;
    if (joint.type == RobotDescription::JointType::kPlanar ||
        joint.type == RobotDescription::JointType::kFloating) {
      throw ModelError(where(joint), "type", "an attached joint that can be held at one position",
                       joint.type == RobotDescription::JointType::kPlanar ? "planar" : "floating",
                       "ignore attached bodies, or make it fixed");
    }
    const Eigen::Vector3d axis = joint.axis.stableNormalized();
    if (joint.type == RobotDescription::JointType::kPrismatic) {
      X.p = position(j) * axis;
    } else {
      X.R = Eigen::AngleAxisd(position(j), axis).toRotationMatrix();
    }
    return X;
  }

  /// A sentence for each given position that had no influence or is beyond the joint's limits.
  std::vector<std::string> warnings(bool lump_attached) const {
    std::vector<std::string> texts;
    for (std::size_t j = 0; j < given_.size(); ++j) {
      const RobotDescription::Joint& joint = robot_.joints[j];
      if (given_[j] && !used_[j]) {
        const std::string reason =
            !isMovable(joint) ? "the joint is fixed"
            : joint.mimic     ? "the joint follows joint " + robot_.joints[joint.mimic->joint].name
            : !lump_attached  ? "attached bodies are ignored"
                              : "no moving link carries the joint";
        texts.push_back(printable("URDF:" + std::to_string(joint.line) + ": joint " + joint.name +
                                  ": its locked position isn't used: " + reason));
      } else if (used_[j]) {
        const std::string doubt = positionDoubt(joint, *given_[j]);
        if (!doubt.empty()) texts.push_back(doubt);
      }
    }
    return texts;
  }

 private:
  bool movesItself(std::size_t j) const { return isMovable(robot_.joints[j]) && !given_[j]; }

  /// The position of a joint, or the one that it has by following others.
  double position(std::size_t j) {
    Joints followers;
    std::size_t source = j;
    while (!position_[source] && robot_.joints[source].mimic) {
      followers.push_back(source);
      source = robot_.joints[source].mimic->joint;
      const bool endless = followers.size() > robot_.joints.size();
      if (endless || (onPath(source) && moves(source))) {
        const std::string& leader = robot_.joints[source].name;
        throw ModelError(where(robot_.joints[followers.back()]), "<mimic>",
                         "a joint that can be held",
                         (endless ? "one that follows itself through joint "
                                  : "one that moves with the chain's joint ") +
                             leader,
                         endless     ? "take a <mimic> out of the loop"
                         : onPath(j) ? "hold joint " + leader + " at a position instead, or neither"
                                     : "add a tip beyond it, ignore attached bodies, or make it "
                                       "fixed");
      }
    }
    if (!position_[source]) position_[source] = givenPosition(source);
    while (!followers.empty()) {
      const RobotDescription::Mimic& mimic = *robot_.joints[followers.back()].mimic;
      position_[followers.back()] = mimic.multiplier * *position_[source] + mimic.offset;
      source = followers.back();
      followers.pop_back();
    }
    return *position_[j];
  }

  double givenPosition(std::size_t j) {
    if (!given_[j] || !isMovable(robot_.joints[j])) return 0;
    used_[j] = true;
    if (!std::isfinite(*given_[j])) {
      throw ModelError(where(robot_.joints[j]), "locked position", "a finite number",
                       std::to_string(*given_[j]), "");
    }
    return *given_[j];
  }

  const RobotDescription& robot_;
  std::vector<bool> on_path_;
  std::vector<bool> used_;
  std::vector<std::optional<double>> given_;
  std::vector<std::optional<double>> position_;  // of those asked for
};

}  // namespace paths
}  // namespace v2
}  // namespace chain_dynamics
