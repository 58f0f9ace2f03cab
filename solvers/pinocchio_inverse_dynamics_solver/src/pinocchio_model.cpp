// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_model.hpp"

#include <Eigen/Geometry>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cstddef>
#include <vector>

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// Pinocchio wants the center of mass and the inertia about it; ours is about the origin of the
/// frame.
pinocchio::Inertia inertia(const chain_dynamics::LinkParameters& link) {
  const double m = link.mass;
  // (Masses are positive or zero, so without mass there is no first moment.)
  const Eigen::Vector3d c = m == 0.0 ? Eigen::Vector3d::Zero() : (link.first_moment / m).eval();

  // I_c = I + m [c]x [c]x (parallel axes)
  const Eigen::Matrix3d c_x = chain_dynamics::skew<double>(c);
  return {m, c, Eigen::Matrix3d(link.inertia + m * c_x * c_x)};
}

}  // namespace

Model toPinocchio(const chain_dynamics::Chain& chain) {
  Model model;
  model.name = chain.name();
  model.gravity = pinocchio::Motion(chain.gravity(), Eigen::Vector3d::Zero());
  pinocchio::JointIndex last = 0;  // the root link
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    const chain_dynamics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const pinocchio::SE3 X(joint.placement.R, joint.placement.p);
    last = isPrismatic(joint)
               ? model.addJoint(last, Model::JointCollection::Prismatic(), X, joint.name)
               : model.addJoint(last, Model::JointCollection::Revolute(), X, joint.name);
    model.appendBodyToJoint(last, inertia(chain.links()[static_cast<std::size_t>(i)]));
    model.armature[i] = joint.rotor_inertia;
  }
  const pinocchio::SE3 tip(chain.tip().R, chain.tip().p);
  model.addFrame(Model::Frame("tip", last, tip, pinocchio::OP_FRAME));
  return model;
}

Model toPinocchio(const chain_dynamics::RobotDescription& robot) {
  using chain_dynamics::RobotDescription;
  const auto placed = [](const chain_dynamics::Transform<double>& X) {
    return pinocchio::SE3(X.R, X.p);
  };
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
      pose[i] = pose[joint.parent] * placed(joint.placement);
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
          pose[i] * placed(link.inertial->placement));
    }
    model.addFrame(Model::Frame(link.name, moved[i], pose[i], pinocchio::OP_FRAME));
  }
  return model;
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
