// SPDX-License-Identifier: Apache-2.0
#include "frames.hpp"

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/spatial.hpp>
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

[[noreturn]] void refuseFrame(const std::string& method, const std::string& expected,
                              const std::string& got, const std::string& remedy) {
  throw ids::InvalidParameterValueException(
      ids::errorText(method + ": argument frame", "", expected, got, remedy));
}

/// The link of that name, or the one that the joint of that name moves.
std::size_t linkOf(const RobotDescription& robot, const std::string& frame,
                   const std::string& method) {
  const std::size_t joint = robot.jointIndex(frame);
  const std::size_t link =
      joint == RobotDescription::kNone ? robot.linkIndex(frame) : robot.joints[joint].child;
  if (link != RobotDescription::kNone) return link;
  std::vector<std::string> known;
  known.reserve(robot.links.size() + robot.joints.size());
  for (const auto& each : robot.links) known.push_back(each.name);
  for (const auto& each : robot.joints) known.push_back(each.name);
  const std::string nearest = chain_dynamics::nearestName(frame, known);
  refuseFrame(method, "a link or joint of the robot description", "'" + frame + "'",
              nearest.empty() ? "known: " + chain_dynamics::joined(known)
                              : "did you mean '" + nearest + "'?");
}

/// The topmost link that a link is fixed to, and the link's pose there.
struct Carrier {
  std::size_t link;
  chain_dynamics::Transform<double> pose = chain_dynamics::Transform<double>::identity();
};

Carrier carrierOf(const RobotDescription& robot, std::size_t link) {
  Carrier carrier{link};
  for (std::size_t j = robot.links[link].parent_joint;
       j != RobotDescription::kNone && !isMovable(robot.joints[j]);
       j = robot.links[carrier.link].parent_joint) {
    carrier = {robot.joints[j].parent, robot.joints[j].placement * carrier.pose};
  }
  return carrier;
}

}  // namespace

Frames::Path Frames::pathTo(const std::string& frame, const std::string& method) const {
  if (urdf_.empty()) {
    refuseFrame(method, "a robot description that says where it is",
                "'" + frame + "' and no description",
                "give urdf=, or leave frame= out for the tip");
  }
  RobotDescription robot = chain_dynamics::robotFromUrdf(urdf_);
  if (robot.jointIndex(of_.joints.front()) == RobotDescription::kNone) {
    refuseFrame(method, "a robot description with joint " + of_.joints.front(), "one without it",
                "leave frame= out for the tip");
  }
  const std::size_t link = linkOf(robot, frame, method);
  const std::size_t root = of_.root.empty() ? robot.root : robot.linkIndex(of_.root);
  Path path;
  if (root == RobotDescription::kNone) return path;
  const Carrier of_link = carrierOf(robot, link), of_root = carrierOf(robot, root);
  if (of_link.link == of_root.link) {
    path.fixed = of_root.pose.inverse() * of_link.pose;
    return path;
  }
  chain_dynamics::UrdfOptions options;
  options.root = of_.root;
  options.tip = robot.links[link].name;
  options.lump_attached = false;
  options.allow_massless = true;
  const RobotDescription followed = robot;
  for (auto& joint : robot.joints)
    joint.mimic.reset();  // each moves here; addTo() says which follow
  path.chain = std::make_unique<chain_dynamics::Chain>(chainFromRobot(robot, options));
  for (const std::string& name : path.chain->jointNames()) {
    addTo(path, followed, followed.jointIndex(name));
  }
  return path;
}

void Frames::addTo(Path& path, const RobotDescription& robot, std::size_t joint) const {
  double factor = 1, offset = 0;
  Eigen::Index ours = -1;
  for (std::size_t steps = 0; steps <= robot.joints.size(); ++steps) {  // few, unless in a loop
    const RobotDescription::Joint& leader = robot.joints[joint];
    const auto locked = of_.locked.find(leader.name);
    const auto found = std::find(of_.joints.begin(), of_.joints.end(), leader.name);
    if (locked != of_.locked.end()) offset += factor * locked->second;
    if (found != of_.joints.end()) ours = found - of_.joints.begin();
    if (locked != of_.locked.end() || ours >= 0 || !leader.mimic) break;
    offset += factor * leader.mimic->offset;
    factor *= leader.mimic->multiplier;
    joint = leader.mimic->joint;
  }
  const Eigen::Index i = path.q.size();
  path.numbers.push_back(ours);
  path.q.conservativeResize(i + 1);
  path.factors.conservativeResize(i + 1);
  path.q[i] = offset;
  path.factors[i] = factor;
}

const Frames::Path& Frames::to(const std::string& frame, const std::string& method) const {
  const std::lock_guard<std::mutex> alone(busy_);
  const auto found = paths_.find(frame);
  if (found != paths_.end()) return found->second;
  return paths_.emplace(frame, pathTo(frame, method)).first->second;
}

void Frames::Path::setPositions(const chain_dynamics::ConstStates& states, Eigen::Index k,
                                Eigen::VectorXd& of_path) const {
  for (Eigen::Index own = 0; own < of_path.size(); ++own) {
    const Eigen::Index j = numbers[static_cast<std::size_t>(own)];
    of_path[own] = j < 0 ? q[own] : q[own] + factors[own] * states(j, k);
  }
}

void Frames::Path::jacobians(const chain_dynamics::ConstStates& states,
                             const chain_dynamics::StridedMatrices& J) const {
  Eigen::VectorXd of_path = q;
  Eigen::MatrixXd J_path(6, q.size());
  for (Eigen::Index k = 0; k < states.count; ++k) {
    setPositions(states, k, of_path);
    if (chain) chain_dynamics::tipJacobian(*chain, of_path, J_path);
    for (Eigen::Index j = 0; j < states.joints; ++j) {
      for (Eigen::Index i = 0; i < 6; ++i) J(i, j, k) = 0.0;
    }
    for (Eigen::Index own = 0; own < q.size(); ++own) {
      const Eigen::Index j = numbers[static_cast<std::size_t>(own)];
      for (Eigen::Index i = 0; i < 6 && j >= 0; ++i) J(i, j, k) += factors[own] * J_path(i, own);
    }
  }
}

void Frames::Path::poses(const chain_dynamics::ConstStates& states,
                         const chain_dynamics::StridedMatrices& R,
                         const chain_dynamics::States& p) const {
  Eigen::VectorXd of_path = q;
  for (Eigen::Index k = 0; k < states.count; ++k) {
    setPositions(states, k, of_path);
    const auto pose = chain ? chain_dynamics::tipPose(*chain, of_path) : fixed;
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) R(i, j, k) = pose.R(i, j);
      p(i, k) = pose.p[i];
    }
  }
}

}  // namespace inverse_dynamics_tools
