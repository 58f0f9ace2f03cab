// SPDX-License-Identifier: Apache-2.0
#include "frames.hpp"

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/states.hpp>
#include <chain_dynamics/text.hpp>
#include <chain_dynamics/tip_kinematics.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_tools {
namespace {

namespace ids = inverse_dynamics_solver;
using chain_dynamics::RobotDescription;

[[noreturn]] void refuseFrame(const std::string& expected, const std::string& got,
                              const std::string& remedy) {
  throw ids::InvalidParameterValueException(
      ids::errorText("jacobian: argument frame", "", expected, got, remedy));
}

/// The link of that name, or the one that the joint of that name moves.
std::size_t linkOf(const RobotDescription& robot, const std::string& frame) {
  const std::size_t joint = robot.jointIndex(frame);
  const std::size_t link =
      joint == RobotDescription::kNone ? robot.linkIndex(frame) : robot.joints[joint].child;
  if (link != RobotDescription::kNone) return link;
  std::vector<std::string> known;
  known.reserve(robot.links.size() + robot.joints.size());
  for (const auto& each : robot.links) known.push_back(each.name);
  for (const auto& each : robot.joints) known.push_back(each.name);
  const std::string nearest = chain_dynamics::nearestName(frame, known);
  refuseFrame("a link or joint of the robot description", "'" + frame + "'",
              nearest.empty() ? "known: " + chain_dynamics::joined(known)
                              : "did you mean '" + nearest + "'?");
}

/// The topmost link that a link is fixed to.
std::size_t carrierOf(const RobotDescription& robot, std::size_t link) {
  for (std::size_t j = robot.links[link].parent_joint;
       j != RobotDescription::kNone && !isMovable(robot.joints[j]);
       j = robot.links[link].parent_joint) {
    link = robot.joints[j].parent;
  }
  return link;
}

}  // namespace

Frames::Path Frames::pathTo(const std::string& frame) const {
  if (urdf_.empty()) {
    refuseFrame("a robot description that says where it is", "'" + frame + "' and no description",
                "give urdf=, or leave frame= out for the tip");
  }
  const RobotDescription robot = chain_dynamics::robotFromUrdf(urdf_);
  if (robot.jointIndex(of_.joints.front()) == RobotDescription::kNone) {
    refuseFrame("a robot description with joint " + of_.joints.front(), "one without it",
                "leave frame= out for the tip");
  }
  const std::size_t link = linkOf(robot, frame);
  const std::size_t root = of_.root.empty() ? robot.root : robot.linkIndex(of_.root);
  Path path;
  if (root == RobotDescription::kNone || carrierOf(robot, link) == carrierOf(robot, root)) {
    return path;
  }
  chain_dynamics::UrdfOptions options;
  options.root = of_.root;
  options.tip = robot.links[link].name;
  options.lump_attached = false;
  options.allow_massless = true;
  path.chain = std::make_unique<chain_dynamics::Chain>(chainFromRobot(robot, options));
  const std::vector<std::string> names = path.chain->jointNames();
  path.q.setZero(static_cast<Eigen::Index>(names.size()));
  std::size_t i = 0;
  while (i < names.size() && i < of_.joints.size() && names[i] == of_.joints[i]) ++i;
  path.shared = static_cast<Eigen::Index>(i);
  for (; i < names.size(); ++i) {
    const auto locked = of_.locked.find(names[i]);
    if (locked != of_.locked.end()) path.q[static_cast<Eigen::Index>(i)] = locked->second;
  }
  return path;
}

const Frames::Path& Frames::to(const std::string& frame) const {
  const std::lock_guard<std::mutex> alone(busy_);
  const auto found = paths_.find(frame);
  return found != paths_.end() ? found->second : paths_.emplace(frame, pathTo(frame)).first->second;
}

void Frames::Path::jacobians(const chain_dynamics::ConstStates& states,
                             const chain_dynamics::StridedMatrices& J) const {
  Eigen::VectorXd of_path = q;
  Eigen::MatrixXd J_path(6, q.size());
  for (Eigen::Index k = 0; k < states.count; ++k) {
    for (Eigen::Index j = 0; j < shared; ++j) of_path[j] = states(j, k);
    if (chain) chain_dynamics::tipJacobian(*chain, of_path, J_path);
    for (Eigen::Index j = 0; j < states.joints; ++j) {
      for (Eigen::Index i = 0; i < 6; ++i) J(i, j, k) = j < shared ? J_path(i, j) : 0.0;
    }
  }
}

}  // namespace inverse_dynamics_tools
