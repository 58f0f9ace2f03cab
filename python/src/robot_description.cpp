// SPDX-License-Identifier: Apache-2.0
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/joint_frame.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/spatial.hpp>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
using chain_dynamics::RobotDescription;
using Transform = chain_dynamics::Transform<double>;

/// A joint, the links that it joins, and the joint that it follows.
struct DescribedJoint : RobotDescription::Joint {
  std::string parent_link;
  std::string child_link;
  std::string leader;  ///< that it mimics; empty: none
};

RobotDescription descriptionOf(const std::string& urdf) {
  try {
    return chain_dynamics::robotFromUrdf(urdf);
  } catch (const chain_dynamics::ModelError& error) {
    throwError("RobotError", error.what());
  }
}

DescribedJoint described(const RobotDescription& robot, const RobotDescription::Joint& joint) {
  return {joint, robot.links[joint.parent].name, robot.links[joint.child].name,
          joint.mimic ? robot.joints[joint.mimic->joint].name : ""};
}

std::size_t linkOf(const RobotDescription& robot, const std::string& name) {
  if (name.empty()) return robot.root;
  const std::size_t link = robot.linkIndex(name);
  if (link != RobotDescription::kNone) return link;
  throwError("RobotError", "robot description: expected a link '" + name + "', got none");
}

/// A link and the links above it to which it is fixed, upwards; each with its pose in the frame of
/// the first.
std::vector<std::pair<std::size_t, Transform>> fixedAbove(const RobotDescription& robot,
                                                          std::size_t link) {
  std::vector<std::pair<std::size_t, Transform>> found{{link, Transform::identity()}};
  for (std::size_t j = robot.links[link].parent_joint;
       j != RobotDescription::kNone && !isMovable(robot.joints[j]);
       j = robot.links[found.back().first].parent_joint) {
    const Transform pose = found.back().second * robot.joints[j].placement.inverse();
    found.emplace_back(robot.joints[j].parent, pose);
  }
  return found;
}

/// A joint, placed in a link above it.
DescribedJoint placedIn(const RobotDescription& robot, std::size_t link, std::size_t joint) {
  DescribedJoint placed = described(robot, robot.joints[joint]);
  placed.parent_link = robot.links[link].name;
  if (placed.parent == link) return placed;  // the numbers of the description, not rounded
  const auto above = fixedAbove(robot, link);
  std::size_t at = placed.parent;
  while (true) {
    for (const auto& [carrier, pose] : above) {
      if (carrier != at) continue;
      placed.placement = pose * placed.placement;
      placed.rpy = chain_dynamics::rollPitchYaw(placed.placement.R);
      return placed;
    }
    const std::size_t next = robot.links[at].parent_joint;
    if (next == RobotDescription::kNone) break;
    placed.placement = robot.joints[next].placement * placed.placement;
    at = robot.joints[next].parent;
  }
  throwError("RobotError", "robot description: joint " + placed.name + ": expected it below link " +
                               placed.parent_link +
                               ", or below one that is fixed to it; choose a root nearer to that "
                               "of the description");
}

std::size_t jointOf(const RobotDescription& robot, const std::string& name) {
  const std::size_t joint = robot.jointIndex(name);
  if (joint != RobotDescription::kNone) return joint;
  throwError("RobotError", "robot description: expected a joint '" + name + "', got none");
}

/// The nearest joint above a joint that has one of the names; kNone: there is none.
std::size_t nearestAbove(const RobotDescription& robot, std::size_t joint,
                         const std::vector<std::string>& names) {
  do {
    joint = robot.links[robot.joints[joint].parent].parent_joint;
  } while (joint != RobotDescription::kNone &&
           std::find(names.begin(), names.end(), robot.joints[joint].name) == names.end());
  return joint;
}

std::vector<DescribedJoint> chainOf(const RobotDescription& robot,
                                    const std::vector<std::string>& joints,
                                    const std::string& root) {
  std::vector<DescribedJoint> chain;
  const std::size_t root_link = linkOf(robot, root);
  for (const std::string& name : joints) {
    const std::size_t joint = jointOf(robot, name);
    chain.push_back(placedIn(robot, root_link, joint));
    const std::size_t above = nearestAbove(robot, joint, joints);
    if (above != RobotDescription::kNone) {
      chain.back() = placedIn(robot, robot.joints[above].child, joint);
    }
  }
  return chain;
}

/// The link that the most fixed joints separate from a link above it.
std::string farthestFixedTo(const RobotDescription& robot, std::size_t link) {
  std::vector<std::size_t> links{link};
  for (std::size_t i = 0; i < links.size(); ++i) {  // grows
    for (const std::size_t joint : robot.links[links[i]].child_joints) {
      if (!isMovable(robot.joints[joint])) links.push_back(robot.joints[joint].child);
    }
  }
  return robot.links[links.back()].name;
}

const char* typeOf(const DescribedJoint& joint) {
  static constexpr const char* kNames[] = {"fixed",     "revolute", "continuous",
                                           "prismatic", "planar",   "floating"};
  return kNames[static_cast<std::size_t>(joint.type)];
}

/// What is stated.
std::map<std::string, double> limitsOf(const DescribedJoint& joint) {
  const auto& limits = joint.limits;
  std::map<std::string, double> stated;
  if (std::isfinite(limits.upper - limits.lower)) {
    stated = {{"lower", limits.lower}, {"upper", limits.upper}};
  }
  for (const auto& [name, value] :
       {std::pair("velocity", limits.velocity), std::pair("effort", limits.effort),
        std::pair("acceleration", limits.acceleration),
        std::pair("deceleration", limits.deceleration), std::pair("jerk", limits.jerk)}) {
    if (std::isfinite(value)) stated.emplace(name, value);
  }
  return stated;
}

template <class Matrix>
Floats floats(const Matrix& matrix) {
  return Floats(py::cast(matrix));
}

Floats poseOf(const DescribedJoint& joint) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = joint.placement.R;
  pose.topRightCorner<3, 1>() = joint.placement.p;
  return floats(pose);
}

}  // namespace

void bindRobotDescription(py::module_& module) {
  using Joint = DescribedJoint;
  py::class_<Joint>(module, "DescribedJoint",
                    "A joint of a URDF: its frame in that of the link above, its axis in its own.")
      .def_readonly("name", &Joint::name, "in the description")
      .def_property_readonly("type", &typeOf,
                             "fixed, revolute, continuous, prismatic, planar or floating")
      .def_readonly("parent", &Joint::parent_link, "the link above")
      .def_readonly("child", &Joint::child_link, "the link that it moves")
      .def_property_readonly(
          "xyz", [](const Joint& joint) { return floats(joint.placement.p); },
          "(3,) m, in the frame of the parent")
      .def_property_readonly(
          "rpy", [](const Joint& joint) { return floats(joint.rpy); },
          "(3,) rad: roll, pitch, yaw about fixed axes")
      .def_property_readonly(
          "axis", [](const Joint& joint) { return floats(joint.axis.normalized().eval()); },
          "(3,) of length 1, in the joint's frame")
      .def_property_readonly("limits", &limitsOf,
                             "Those of lower, upper, velocity, effort, acceleration, deceleration "
                             "and jerk that are stated.")
      .def_readonly("damping", &Joint::damping, "N m s/rad (prismatic N s/m); 0: not stated")
      .def_readonly("friction", &Joint::friction, "N m (prismatic N); 0: not stated")
      .def_property_readonly(
          "mimic",
          [](const Joint& joint) -> std::optional<std::tuple<std::string, double, double>> {
            if (!joint.mimic) return {};
            return std::tuple(joint.leader, joint.mimic->multiplier, joint.mimic->offset);
          },
          "The joint that it follows, multiplier and offset [rad, m]; None: it follows none.")
      .def_property_readonly("pose", &poseOf,
                             "(4, 4) of the child in the frame of the parent, at q = 0")
      .def_property_readonly(
          "rotation_from_z",
          [](const Joint& joint) {
            return floats(chain_dynamics::rotationFromZ(joint.axis.normalized()));
          },
          "R_UE (3, 3): U is the description's frame of the child, E the engine's, whose z is the "
          "axis.");
  py::class_<RobotDescription>(module, "RobotDescription",
                               "The links and joints of a URDF, in the order of its text.")
      .def(py::init(&descriptionOf), "urdf"_a, "urdf: its text. Raises RobotError.")
      .def_readonly("name", &RobotDescription::name, "of the robot")
      .def_property_readonly(
          "root", [](const RobotDescription& robot) { return robot.links[robot.root].name; },
          "the link above all others")
      .def_property_readonly(
          "joints",
          [](const RobotDescription& robot) {
            std::vector<Joint> joints;
            joints.reserve(robot.joints.size());
            for (const auto& joint : robot.joints) {
              joints.push_back(described(robot, joint));
            }
            return joints;
          },
          "all, in the order of the text")
      .def(
          "chain", &chainOf, "joints"_a, "root"_a = "",
          "The joints of these names, each placed in the child of the nearest of them above it, or "
          "in the link `root`.\n\nJoints between two of them stand at zero. Raises RobotError.")
      .def(
          "tip",
          [](const RobotDescription& robot, const std::string& joint) {
            return farthestFixedTo(robot, robot.joints[jointOf(robot, joint)].child);
          },
          "joint"_a, "The link farthest behind a joint, by fixed joints.");
}

}  // namespace inverse_dynamics_tools
