// SPDX-License-Identifier: Apache-2.0
/// @file
/// All joints of a robot description as Pinocchio's model, for tests and benchmarks.
#pragma once

#include <Eigen/Geometry>
#include <chain_dynamics/robot_description.hpp>
#include <cstddef>
#include <vector>

#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

/// The joints that move, parents first, by their names, whatever they mimic; a frame for each link, by its
/// name. Gravity is zero.
inline Model toPinocchio(const chain_dynamics::RobotDescription& robot) {
  using chain_dynamics::RobotDescription;
  Model model;
  model.name = robot.name;
  model.gravity.setZero();
  // of each link: the joint that moves it, and its pose in that joint's frame
  std::vector<pinocchio::JointIndex> moved(robot.links.size(), 0);
  std::vector<pinocchio::SE3> pose(robot.links.size(), pinocchio::SE3::Identity());
  for (const std::size_t i : robot.linksBelow(robot.root)) {
    const RobotDescription::Link& link = robot.links[i];
    if (link.parent_joint != RobotDescription::kNone) {
      const RobotDescription::Joint& joint = robot.joints[link.parent_joint];
      moved[i] = moved[joint.parent];
      pose[i] = pose[joint.parent] * pinocchio::SE3(joint.placement.R, joint.placement.p);
      if (isMovable(joint)) {
        const Eigen::Quaterniond to_axis =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), joint.axis);
        const pinocchio::SE3 turned(to_axis.toRotationMatrix(), Eigen::Vector3d::Zero());
        const pinocchio::SE3 X = pose[i] * turned;
        moved[i] =
            joint.type == RobotDescription::JointType::kPrismatic
                ? model.addJoint(moved[i], Model::JointCollection::Prismatic(), X, joint.name)
                : model.addJoint(moved[i], Model::JointCollection::Revolute(), X, joint.name);
        pose[i] = turned.inverse();
      }
    }
    if (link.inertial) {
      model.appendBodyToJoint(
          moved[i],
          pinocchio::Inertia(link.inertial->mass, Eigen::Vector3d::Zero(), link.inertial->inertia),
          pose[i] * pinocchio::SE3(link.inertial->placement.R, link.inertial->placement.p));
    }
    model.addFrame(Model::Frame(link.name, moved[i], pose[i], pinocchio::OP_FRAME));
  }
  return model;
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
