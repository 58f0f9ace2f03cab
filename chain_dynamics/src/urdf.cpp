// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/urdf.hpp"

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "joint_frame.hpp"
#include "urdf_check.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using JointPtr = urdf::JointConstSharedPtr;
using LinkPtr = urdf::LinkConstSharedPtr;
using Path = std::vector<JointPtr>;

bool isFixed(const urdf::Joint& joint) { return joint.type == urdf::Joint::FIXED; }

Eigen::Vector3d vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Transform<double> pose(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(),
          vector(pose.position)};
}

/// Parameters of a URDF link in the link's frame, without what hangs on it.
LinkParameters parameters(const urdf::Link& link) {
  if (link.inertial == nullptr) {
    return LinkParameters::zero();
  }
  const urdf::Inertial& given = *link.inertial;
  Eigen::Matrix3d about_center;
  about_center << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz,
      given.iyz, given.izz;
  // the given axes are those of <origin>, whose origin is the center of mass
  return pose(given.origin) *
         LinkParameters::fromCenterOfMass(given.mass, Eigen::Vector3d::Zero(), about_center);
}

// ---------------------------------------------------------------------------------------------
// Names

/// The link of that name; an unknown name is answered by the nearest known ones.
LinkPtr linkNamed(const urdf::ModelInterface& robot, const std::string& name,
                  const std::string& role) {
  if (LinkPtr link = robot.getLink(name)) {
    return link;
  }
  constexpr std::size_t kShown = 8;
  std::vector<std::pair<std::size_t, std::string>> known;
  for (const auto& [link_name, link] : robot.links_) {
    known.emplace_back(editDistance(name, link_name), link_name);
  }
  std::sort(known.begin(), known.end());

  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < std::min(kShown, known.size()); ++i) {
    nearest.push_back(known[i].second);
  }
  throw ModelError("URDF: robot " + robot.getName(), role, "a link of the robot", "'" + name + "'",
                   (known.size() > kShown ? "nearest names: " : "links: ") + joined(nearest));
}

// ---------------------------------------------------------------------------------------------
// Paths

/// The joints from root to tip, or nothing if tip isn't below root.
bool findPath(const LinkPtr& root, const LinkPtr& tip, Path& path) {
  path.clear();
  for (LinkPtr link = tip; link != root; link = link->getParent()) {
    if (link->parent_joint == nullptr) {
      return false;
    }
    path.push_back(link->parent_joint);
  }
  std::reverse(path.begin(), path.end());
  return true;
}

Path pathBetween(const urdf::ModelInterface& robot, const LinkPtr& root, const LinkPtr& tip) {
  Path path;
  if (!findPath(root, tip, path)) {
    const bool swapped = findPath(tip, root, path);
    throw ModelError(
        "URDF: robot " + robot.getName(), "tip", "a link below root '" + root->name + "'",
        "'" + tip->name + "'",
        swapped ? "swap root and tip" : "choose a root nearer to '" + robot.getRoot()->name + "'");
  }
  return path;
}

/// A leaf with the joints above it.
struct Leaf {
  LinkPtr link;
  Path path;
  std::vector<std::string> movable;  // names of its movable joints, in order
};

void collectLeaves(const LinkPtr& link, Leaf& above, std::vector<Leaf>& leaves) {
  if (link->child_joints.empty()) {
    leaves.push_back(above);
    leaves.back().link = link;
  }
  for (std::size_t i = 0; i < link->child_joints.size(); ++i) {
    Leaf below = above;
    below.path.push_back(link->child_joints[i]);
    if (!isFixed(*link->child_joints[i])) {
      below.movable.push_back(link->child_joints[i]->name);
    }
    collectLeaves(link->child_links[i], below, leaves);
  }
}

bool isPrefix(const std::vector<std::string>& part, const std::vector<std::string>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

/// The joints from root to the one leaf that all movable joints lead to.
Path pathToLeaf(const urdf::ModelInterface& robot, const LinkPtr& root) {
  std::vector<Leaf> leaves;
  Leaf start;
  collectLeaves(root, start, leaves);
  const auto farther = [](const Leaf& a, const Leaf& b) {
    return std::make_pair(a.movable.size(), a.path.size()) <
           std::make_pair(b.movable.size(), b.path.size());
  };
  const Leaf& tip = *std::max_element(leaves.begin(), leaves.end(), farther);

  // leaves moved by joints that don't lead to this tip
  std::string others;
  for (const Leaf& leaf : leaves) {
    if (!isPrefix(leaf.movable, tip.movable)) {
      others += ", " + leaf.link->name + " (moved by " + leaf.movable.back() + ")";
    }
  }
  if (!others.empty()) {
    throw ModelError("URDF: robot " + robot.getName(), "tip", "one leaf below '" + root->name + "'",
                     tip.link->name + " (moved by " + tip.movable.back() + ")" + others,
                     "name one of them as tip");
  }
  return tip.path;
}

// ---------------------------------------------------------------------------------------------
// The chain

/// Makes joints and links of a chain from the URDF joints on its path.
class Builder {
 public:
  Builder(const urdf::ModelInterface& robot, const UrdfOptions& options, Path path)
      : robot_(robot), options_(options), path_(std::move(path)) {}

  Chain chain() {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const urdf::Joint& joint = *path_[i];
      X_EU_ = X_EU_ * pose(joint.parent_to_joint_origin_transform);
      if (!isFixed(joint)) {
        addJoint(joint);
      }
      if (!links_.empty()) {
        links_.back() += X_EU_ * parameters(link(i));
        lumpBranches(i);
      }
    }
    checkMovable();
    for (LinkParameters& parameters : links_) {
      parameters = symmetric(parameters);
    }
    return {robot_.getName(), std::move(joints_), std::move(links_), options_.gravity, X_EU_};
  }

 private:
  /// The link that joint i of the path moves.
  const urdf::Link& link(std::size_t i) const { return *robot_.getLink(path_[i]->child_link_name); }

  bool onPath(const urdf::Joint& joint) const {
    return std::any_of(path_.begin(), path_.end(),
                       [&joint](const JointPtr& other) { return other.get() == &joint; });
  }

  static std::string where(const urdf::Joint& joint) { return "URDF: joint " + joint.name; }

  /// Starts a new link of the chain, whose frame E is the URDF's U turned to the joint's axis.
  void addJoint(const urdf::Joint& joint) {
    if (joint.type == urdf::Joint::PLANAR || joint.type == urdf::Joint::FLOATING) {
      throw ModelError(where(joint), "type", "revolute, continuous, prismatic or fixed",
                       joint.type == urdf::Joint::PLANAR ? "planar" : "floating",
                       "choose root and tip so that it isn't between them");
    }
    if (joint.mimic != nullptr) {
      throw ModelError(where(joint), "<mimic>", "a joint that moves by itself",
                       "one that follows joint " + joint.mimic->joint_name,
                       "choose root and tip so that it isn't between them");
    }
    const Matrix3<double> R_UE = rotationFromZ(vector(joint.axis).stableNormalized());
    Joint result;
    result.name = joint.name;
    result.type = joint.type == urdf::Joint::PRISMATIC    ? JointType::kPrismatic
                  : joint.type == urdf::Joint::CONTINUOUS ? JointType::kContinuous
                                                          : JointType::kRevolute;
    result.placement = {X_EU_.R * R_UE, X_EU_.p};
    result.limits = limits(joint);
    if (joint.dynamics != nullptr) {
      result.damping = joint.dynamics->damping;
      result.friction = joint.dynamics->friction;
    }
    joints_.push_back(result);
    links_.push_back(LinkParameters::zero());
    X_EU_ = {R_UE.transpose(), Eigen::Vector3d::Zero()};
  }

  static JointLimits limits(const urdf::Joint& joint) {
    JointLimits result;
    if (joint.limits != nullptr) {
      result.velocity = joint.limits->velocity;
      result.effort = joint.limits->effort;
      if (joint.type != urdf::Joint::CONTINUOUS) {
        result.lower = joint.limits->lower;
        result.upper = joint.limits->upper;
      }
    }
    return result;
  }

  /// Adds what hangs on a link of the path, beside the path or beyond its end.
  void lumpBranches(std::size_t i) {
    if (!options_.lump_attached) {
      return;
    }
    for (const auto& child : link(i).child_joints) {
      if (!onPath(*child)) {
        links_.back() += X_EU_ * branch(*child);
      }
    }
  }

  /// A branch as one rigid body, in the frame of the link it hangs on.
  LinkParameters branch(const urdf::Joint& joint) const {
    const urdf::Link& link = *robot_.getLink(joint.child_link_name);
    LinkParameters body = parameters(link);
    for (const auto& child : link.child_joints) {
      body += branch(*child);
    }
    return pose(joint.parent_to_joint_origin_transform) * (lockedMotion(joint) * body);
  }

  /// Where a joint off the path has moved its link.
  Transform<double> lockedMotion(const urdf::Joint& joint) const {
    auto X = Transform<double>::identity();
    if (isFixed(joint)) {
      return X;
    }
    if (joint.type == urdf::Joint::PLANAR || joint.type == urdf::Joint::FLOATING) {
      throw ModelError(where(joint), "type", "an attached joint that can be held at one position",
                       joint.type == urdf::Joint::PLANAR ? "planar" : "floating",
                       "ignore attached bodies, or make it fixed");
    }
    const double position = lockedPosition(joint, robot_.joints_.size());
    const Eigen::Vector3d axis = vector(joint.axis).stableNormalized();
    if (joint.type == urdf::Joint::PRISMATIC) {
      X.p = position * axis;
    } else {
      X.R = Eigen::AngleAxisd(position, axis).toRotationMatrix();
    }
    return X;
  }

  /// @param depth  how many more joints may be followed: a mimic of a mimic may come back.
  double lockedPosition(const urdf::Joint& joint, std::size_t depth) const {
    if (joint.mimic != nullptr) {
      const urdf::Joint& source = *robot_.getJoint(joint.mimic->joint_name);
      if (onPath(source) || depth == 0) {
        throw ModelError(where(joint), "<mimic>", "an attached joint that can be held",
                         (depth == 0 ? "one that follows itself through joint "
                                     : "one that moves with the chain's joint ") +
                             source.name,
                         "ignore attached bodies, or make it fixed");
      }
      return joint.mimic->multiplier * lockedPosition(source, depth - 1) + joint.mimic->offset;
    }
    const double position = options_.locked_position ? options_.locked_position(joint.name) : 0.0;
    if (!std::isfinite(position)) {
      throw ModelError(where(joint), "locked position", "a finite number", std::to_string(position),
                       "");
    }
    return position;
  }

  void checkMovable() const {
    const std::string from_to = path_.empty()
                                    ? "root and tip are the same link"
                                    : "only fixed joints from " + path_.front()->parent_link_name +
                                          " to " + path_.back()->child_link_name;
    if (joints_.empty()) {
      throw ModelError("URDF: robot " + robot_.getName(), "chain", "at least one movable joint",
                       from_to, "choose other root and tip");
    }
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (!options_.allow_massless && links_[i].toVector().isZero(0)) {
        throw ModelError("URDF: joint " + joints_[i].name, "the body it moves", "a mass",
                         "no mass and no inertia",
                         "give link " + robot_.getJoint(joints_[i].name)->child_link_name +
                             " an <inertial>, or allow massless bodies");
      }
    }
  }

  const urdf::ModelInterface& robot_;
  const UrdfOptions& options_;
  const Path path_;
  std::vector<Joint> joints_;
  std::vector<LinkParameters> links_;
  /// Pose of the URDF's current link frame U in the chain's current link frame E.
  Transform<double> X_EU_ = Transform<double>::identity();
};

}  // namespace

Chain chainFromUrdf(const std::string& urdf_xml, const UrdfOptions& options) {
  const urdf::ModelInterfaceSharedPtr robot = urdf::parseURDF(checkedUrdf(urdf_xml));
  if (robot == nullptr) {
    throw ModelError("URDF", "robot description", "a URDF that urdfdom reads", "one it refuses",
                     "its reason is on standard error");
  }
  const LinkPtr root =
      options.root.empty() ? robot->getRoot() : linkNamed(*robot, options.root, "root");
  Path path = options.tip.empty()
                  ? pathToLeaf(*robot, root)
                  : pathBetween(*robot, root, linkNamed(*robot, options.tip, "tip"));
  return Builder(*robot, options, std::move(path)).chain();
}

}  // namespace v2
}  // namespace chain_dynamics
