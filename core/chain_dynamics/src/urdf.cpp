// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/urdf.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/text.hpp"
#include "definite_inertia.hpp"
#include "follower.hpp"
#include "plausibility.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Link = RobotDescription::Link;
using Type = RobotDescription::JointType;
using Joints = std::vector<std::size_t>;

constexpr std::size_t kNone = RobotDescription::kNone;

/// A joint on the way from root to tip, passed from its parent link to its child, or up.
struct Step {
  std::size_t joint = kNone;
  bool up = false;
};
using Path = std::vector<Step>;

/// Gravity where none is given, in the frame of the chain's root [m/s^2].
const Eigen::Vector3d kDown(0, 0, -9.81);

/// [rad] Angles written as 3.14 and 1.57 are off by less; it changes gravity torques by 1 %.
constexpr double kUpright = 0.01;

/// To four decimals, without a negative zero.
double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

/// Parameters of a link in its frame, without attached bodies.
LinkParameters parameters(const Link& link) {
  if (!link.inertial) return LinkParameters::zero();
  // the given axes are those of <origin>, whose origin is the center of mass
  return link.inertial->placement * LinkParameters::fromCenterOfMass(link.inertial->mass,
                                                                     Eigen::Vector3d::Zero(),
                                                                     link.inertial->inertia);
}

std::string where(const RobotDescription& robot) { return "URDF: robot " + robot.name; }

std::string where(const RobotDescription::Joint& joint) { return "URDF: joint " + joint.name; }

// ---------------------------------------------------------------------------------------------
// Paths

/// The link of that name; an unknown name is answered by the nearest known ones.
std::size_t linkNamed(const RobotDescription& robot, const std::string& name,
                      const std::string& role) {
  const std::size_t link = robot.linkIndex(name);
  if (link != kNone) return link;
  constexpr std::size_t kShown = 8;
  std::vector<std::pair<std::size_t, std::string>> known;
  known.reserve(robot.links.size());
  for (const Link& other : robot.links) {
    known.emplace_back(editDistance(name, other.name), other.name);
  }
  std::sort(known.begin(), known.end());

  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < std::min(kShown, known.size()); ++i) {
    nearest.push_back(known[i].second);
  }
  throw ModelError(where(robot), role, "a link of the robot", "'" + name + "'",
                   (known.size() > kShown ? "nearest names: " : "links: ") + joined(nearest));
}

/// The joints between the root of the robot and a link, the link's own first.
Joints jointsAbove(const RobotDescription& robot, std::size_t link) {
  Joints above;
  for (; robot.links[link].parent_joint != kNone; link = robot.joints[above.back()].parent) {
    above.push_back(robot.links[link].parent_joint);
  }
  return above;
}

/// Up from root to the first link that is above both, then down to tip.
Path pathBetween(const RobotDescription& robot, std::size_t root, std::size_t tip) {
  Joints up = jointsAbove(robot, root);
  Joints down = jointsAbove(robot, tip);
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  Path path;
  for (const std::size_t j : up) path.push_back({j, true});
  for (auto j = down.rbegin(); j != down.rend(); ++j) path.push_back({*j, false});
  return path;
}

/// A link with what is between it and the root.
struct Reach {
  std::size_t link = kNone;
  std::size_t movable = 0;           // joints
  std::size_t joints = 0;            // fixed ones, too
  std::size_t last_movable = kNone;  // joint
};

/// The links below root that have no children.
std::vector<Reach> leavesBelow(const RobotDescription& robot, std::size_t root) {
  std::vector<Reach> reach(robot.links.size());
  std::vector<Reach> leaves;
  for (const std::size_t link : robot.linksBelow(root)) {
    reach[link].link = link;
    for (const std::size_t j : robot.links[link].child_joints) {
      const bool movable = isMovable(robot.joints[j]);
      reach[robot.joints[j].child] = {kNone, reach[link].movable + (movable ? 1 : 0),
                                      reach[link].joints + 1,
                                      movable ? j : reach[link].last_movable};
    }
    if (robot.links[link].child_joints.empty()) leaves.push_back(reach[link]);
  }
  return leaves;
}

/// Which tips to name where leaves, the farthest one first, are moved by different joints.
std::string tipsToName(const RobotDescription& robot, std::size_t root,
                       const std::vector<Reach>& leaves) {
  // the joints above all of them
  Joints shared = jointsAbove(robot, leaves.front().link);
  for (const Reach& leaf : leaves) {
    const Joints above = jointsAbove(robot, leaf.link);
    const auto parting =
        std::mismatch(shared.rbegin(), shared.rend(), above.rbegin(), above.rend()).first;
    shared.erase(shared.begin(), parting.base());
  }
  const auto movable = [&robot](const Joints& joints) {
    return static_cast<std::size_t>(std::count_if(
        joints.begin(), joints.end(), [&](std::size_t j) { return isMovable(robot.joints[j]); }));
  };
  // an arm with a gripper, not a body with arms
  const std::size_t arm = movable(shared) - movable(jointsAbove(robot, root));
  if (2 * arm < leaves.front().movable) return "name one of them as tip, or several for a tree";
  return "name '" + robot.links[robot.joints[shared.front()].child].name +
         "' as tip, where they part, or one of them";
}

/// The one leaf below root that all movable joints lead to.
std::size_t leafBelow(const RobotDescription& robot, std::size_t root) {
  const std::vector<Reach> leaves = leavesBelow(robot, root);
  const auto farther = [](const Reach& a, const Reach& b) {
    return std::make_pair(a.movable, a.joints) < std::make_pair(b.movable, b.joints);
  };
  const Reach& tip = *std::max_element(leaves.begin(), leaves.end(), farther);

  // leaves moved by joints that don't lead to this tip
  std::vector<bool> on_path(robot.joints.size(), false);
  for (const std::size_t j : jointsAbove(robot, tip.link)) on_path[j] = true;
  const auto described = [&robot](const Reach& leaf) {
    return robot.links[leaf.link].name + " (moved by " + robot.joints[leaf.last_movable].name + ")";
  };
  std::vector<Reach> rivals{tip};
  std::string others;
  for (const Reach& leaf : leaves) {
    if (leaf.last_movable == kNone || on_path[leaf.last_movable]) continue;
    rivals.push_back(leaf);
    others += ", " + described(leaf);
  }
  if (!others.empty()) {
    throw ModelError(where(robot), "tip", "one leaf below '" + robot.links[root].name + "'",
                     described(tip) + others, tipsToName(robot, root, rivals));
  }
  return tip.link;
}

/// Which joint a joint follows in the end, through others, and how: itself if it mimics none.
RobotDescription::Mimic leaderOf(const RobotDescription& robot, std::size_t joint) {
  RobotDescription::Mimic leader{joint, 1, 0};
  for (std::size_t steps = 0; robot.joints[leader.joint].mimic; ++steps) {
    const RobotDescription::Mimic& next = *robot.joints[leader.joint].mimic;
    if (steps == robot.joints.size()) {
      throw ModelError(where(robot.joints[joint]), "<mimic>", "a joint that follows another one",
                       "one that follows itself through joint " + robot.joints[next.joint].name,
                       "take a <mimic> out of the loop");
    }
    leader.offset += leader.multiplier * next.offset;
    leader.multiplier *= next.multiplier;
    leader.joint = next.joint;
  }
  return leader;
}

// ---------------------------------------------------------------------------------------------
// Joints that are held

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
    if (joint.type == Type::kPlanar || joint.type == Type::kFloating) {
      throw ModelError(where(joint), "type", "an attached joint that can be held at one position",
                       joint.type == Type::kPlanar ? "planar" : "floating",
                       "ignore attached bodies, or make it fixed");
    }
    const Eigen::Vector3d axis = joint.axis.stableNormalized();
    if (joint.type == Type::kPrismatic) {
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

// ---------------------------------------------------------------------------------------------
// The chain

/// What the chains from one root share.
struct Family {
  LockedJoints locked;
  bool mimics = false;         ///< whether joints may follow others
  std::vector<bool> has_mass;  ///< links that are in a chain, which has their mass
};

/// Makes joints and links of a chain from the URDF joints on its path.
class Builder {
 public:
  Builder(const RobotDescription& robot, const UrdfOptions& options, std::size_t root,
          std::size_t tip, Family& family)
      : robot_(robot),
        options_(options),
        root_(root),
        tip_(tip),
        path_(pathBetween(robot, root, tip)),
        family_(family),
        locked_(family.locked) {}

  /// The chain; links that another chain of the family has moved before have mass here, too.
  Chain chain() {
    for (const Step& step : path_) {
      const RobotDescription::Joint& joint = robot_.joints[step.joint];
      if (!step.up) X_EU_ = X_EU_ * joint.placement;
      const std::size_t link = step.up ? joint.parent : joint.child;
      is_first_ = !family_.has_mass[link];
      if (locked_.moves(step.joint)) {
        addJoint(joint, step.up);
      } else {
        const Transform<double> held = locked_.motion(step.joint);
        X_EU_ = X_EU_ * (step.up ? held.inverse() : held);
      }
      if (step.up) X_EU_ = X_EU_ * joint.placement.inverse();
      if (!links_.empty()) {
        add(X_EU_ * parameters(robot_.links[link]));
        parts_.back().push_back(link);
        lumpBranches(robot_.links[link]);
        family_.has_mass[link] = true;
      }
    }
    checkMovable();
    for (auto* const links : {&links_, &own_}) {
      for (LinkParameters& parameters : *links) parameters = symmetric(parameters);
    }
    Chain chain(robot_.name, joints_, links_, options_.gravity.value_or(kDown), X_EU_);
    if (!options_.allow_massless) checkMassless(chain);
    return chain;
  }

  /// The same without the mass and rotors of what another chain of the family has moved before; after
  /// chain().
  Chain ownPart() const {
    return {robot_.name, joints_, own_, options_.gravity.value_or(kDown), X_EU_};
  }

  /// What is odd: about the description, the held joints, and the parts of each link; after all chains
  /// of the family.
  std::vector<std::string> warnings(const Chain& chain) const {
    std::vector<std::string> texts = robot_.warnings;
    warnOfGravity(texts);
    warnOfSwappedEnds(texts);
    const std::vector<std::string> locked = locked_.warnings(options_.lump_attached);
    texts.insert(texts.end(), locked.begin(), locked.end());
    for (const auto& doubts : {inertiaDoubts(robot_, chain, parts_), limitDoubts(chain)}) {
      texts.insert(texts.end(), doubts.begin(), doubts.end());
    }
    bool named = true;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      named = (inertiaDefect(chain.links()[i]).empty() || addDefects(i, texts)) && named;
    }
    if (!named) {  // not of one part alone
      texts.insert(texts.end(), chain.warnings().begin(), chain.warnings().end());
    }
    return texts;
  }

 private:
  /// Starts a new link of the chain, whose frame E is the URDF's U turned to the joint's axis: U is
  /// that of the joint's child. Passed up, the parent moves about the opposite axis instead.
  void addJoint(const RobotDescription::Joint& joint, bool up) {
    if (joint.type == Type::kPlanar || joint.type == Type::kFloating) {
      throw ModelError(where(joint), "type", "revolute, continuous, prismatic or fixed",
                       joint.type == Type::kPlanar ? "planar" : "floating",
                       "choose root and tip so that it isn't between them");
    }
    if (joint.mimic && !family_.mimics) {
      throw ModelError(where(joint), "<mimic>", "a joint that moves by itself",
                       "one that follows joint " + robot_.joints[joint.mimic->joint].name,
                       "choose root and tip so that it isn't between them; arms with a "
                       "parallelogram aren't supported");
    }
    const Eigen::Vector3d axis = joint.axis.stableNormalized();
    const Matrix3<double> R_UE = rotationFromZ(up ? -axis : axis);
    Joint result;
    result.name = joint.name;
    result.type = joint.type == Type::kPrismatic    ? JointType::kPrismatic
                  : joint.type == Type::kContinuous ? JointType::kContinuous
                                                    : JointType::kRevolute;
    result.placement = {X_EU_.R * R_UE, X_EU_.p};
    result.limits = joint.limits;
    result.damping = joint.damping;
    result.friction = joint.friction;
    if (options_.rotor_inertia && is_first_) result.rotor_inertia = options_.rotor_inertia(joint);
    joints_.push_back(result);
    links_.push_back(LinkParameters::zero());
    own_.push_back(LinkParameters::zero());
    parts_.emplace_back();
    X_EU_ = {R_UE.transpose(), Eigen::Vector3d::Zero()};
  }

  /// Adds a body to the last link.
  void add(const LinkParameters& body) {
    links_.back() += body;
    if (is_first_) own_.back() += body;
  }

  /// Adds bodies attached to a link of the path, beside the path or beyond its end.
  void lumpBranches(const Link& link) {
    if (!options_.lump_attached) return;
    for (const std::size_t j : link.child_joints) {
      if (!locked_.onPath(j)) add(X_EU_ * branch(j));
    }
    if (link.parent_joint != kNone && !locked_.onPath(link.parent_joint)) {
      add(X_EU_ * trunk(link));
    }
  }

  /// A branch as one rigid body, in the frame of the link that carries it.
  LinkParameters branch(std::size_t joint) {
    body_.resize(robot_.joints.size(), LinkParameters::zero());
    const std::vector<std::size_t> links = robot_.linksBelow(robot_.joints[joint].child);
    parts_.back().insert(parts_.back().end(), links.begin(), links.end());
    for (auto link = links.rbegin(); link != links.rend(); ++link) {  // children before parents
      LinkParameters body = parameters(robot_.links[*link]);
      for (const std::size_t child : robot_.links[*link].child_joints) body += body_[child];
      const std::size_t j = robot_.links[*link].parent_joint;
      body_[j] = robot_.joints[j].placement * (locked_.motion(j) * body);
    }
    return body_[joint];
  }

  /// All that isn't below a link, with its branches, as one rigid body in that link's frame; a
  /// floating joint attaches nothing.
  LinkParameters trunk(const Link& link) {
    LinkParameters body = LinkParameters::zero();
    const Joints above = jointsAbove(robot_, robot_.joints[link.parent_joint].child);
    for (auto j = above.rbegin(); j != above.rend(); ++j) {  // parents before children
      const RobotDescription::Joint& joint = robot_.joints[*j];
      if (joint.type == Type::kFloating) {
        body = LinkParameters::zero();
        continue;
      }
      body += parameters(robot_.links[joint.parent]);
      parts_.back().push_back(joint.parent);
      for (const std::size_t child : robot_.links[joint.parent].child_joints) {
        if (child != *j) body += branch(child);
      }
      body = (joint.placement * locked_.motion(*j)).inverse() * body;
    }
    return body;
  }

  void checkMovable() const {
    if (joints_.empty()) {
      const std::string from_to = root_ == tip_
                                      ? "root and tip are the same link"
                                      : "only fixed joints from " + robot_.links[root_].name +
                                            " to " + robot_.links[tip_].name;
      throw ModelError(where(robot_), "chain", "at least one movable joint", from_to,
                       "choose other root and tip");
    }
  }

  /// Massless bodies are right within a joint of several axes, where H is definite all the same.
  void checkMassless(const Chain& chain) const {
    const auto massless =
        std::find_if(links_.begin(), links_.end(),
                     [](const LinkParameters& link) { return link.toVector().isZero(0); });
    if (massless == links_.end() || inertiaIsDefinite(chain)) return;
    const auto i = static_cast<std::size_t>(massless - links_.begin());
    throw ModelError("URDF: joint " + joints_[i].name, "the body it moves",
                     "a mass, or an inertia matrix that is positive definite at every position",
                     "no mass and no inertia",
                     "give link " + robot_.links[parts_[i].front()].name +
                         " an <inertial>, or set allow_massless to true");
  }

  /// Names a default gravity that isn't down the z axis of the description's root.
  void warnOfGravity(std::vector<std::string>& texts) const {
    Matrix3<double> R_DR = Matrix3<double>::Identity();  // of the chain's root in the description's
    for (const std::size_t j : jointsAbove(robot_, root_)) {
      R_DR = robot_.joints[j].placement.R * R_DR;
    }
    const Eigen::Vector3d down = R_DR.transpose() * kDown;
    if (options_.gravity || (down - kDown).norm() < kUpright * kDown.norm()) return;
    const Link& root = robot_.links[root_];
    std::ostringstream text;
    text << "URDF:" << root.line << ": link " << root.name
         << ": gravity isn't given, so it is [0, 0, -9.81] in the frame of this root link; down "
            "the z axis of link "
         << robot_.links[robot_.root].name << " (joints between them at zero) it would be ["
         << rounded(down.x()) << ", " << rounded(down.y()) << ", " << rounded(down.z())
         << "]: give the one that is right";
    texts.push_back(printable(text.str()));
  }

  /// Says which end is held where root and tip may have been taken for each other.
  void warnOfSwappedEnds(std::vector<std::string>& texts) const {
    const auto down = [this](const Step& step) {
      return !step.up && isMovable(robot_.joints[step.joint]);
    };
    if (std::any_of(path_.begin(), path_.end(), down)) return;
    const Link& root = robot_.links[root_];
    texts.push_back(printable("URDF:" + std::to_string(root.line) + ": link " + root.name +
                              ": as the root of the chain it is held, and tip " +
                              robot_.links[tip_].name +
                              " moves, which is above it; swap root and tip if the robot stands on "
                              "its base"));
  }

  /// Names the parts of link i that no rigid body can be; false if there are none.
  bool addDefects(std::size_t i, std::vector<std::string>& texts) const {
    const std::size_t before = texts.size();
    for (const std::size_t part : parts_[i]) {
      const Link& link = robot_.links[part];
      const std::string defect = inertiaDefect(symmetric(parameters(link)));
      if (!defect.empty()) {
        texts.push_back(printable("URDF:" + std::to_string(link.inertial->line) + ": link " +
                                  link.name + ", moved by joint " + joints_[i].name + ": " +
                                  defect));
      }
    }
    return texts.size() > before;
  }

  const RobotDescription& robot_;
  const UrdfOptions& options_;
  const std::size_t root_, tip_;  // links
  const Path path_;
  Family& family_;
  LockedJoints& locked_;
  bool is_first_ = true;  // in the family, to move the current link
  std::vector<Joint> joints_;
  std::vector<LinkParameters> links_;
  std::vector<LinkParameters> own_;              // without what is_first_ is false of
  std::vector<std::vector<std::size_t>> parts_;  // links of the URDF, of each link of the chain
  std::vector<LinkParameters> body_;             // of branches, by joint
  /// Pose of the URDF's current link frame U in the chain's current link frame E.
  Transform<double> X_EU_ = Transform<double>::identity();
};

/// The root of the chain or mechanism.
std::size_t rootOf(const RobotDescription& robot, const UrdfOptions& options) {
  return options.root.empty() ? robot.root : linkNamed(robot, options.root, "root");
}

// ---------------------------------------------------------------------------------------------
// Mechanisms

/// What "*" stands for: see mechanismFromRobot().
std::vector<std::size_t> movedLeaves(const RobotDescription& robot, const UrdfOptions& options,
                                     std::size_t root) {
  struct Leaf {
    std::size_t link, last;  // last joint that moves it
    Joints above;            // that joint is among them
  };
  std::vector<Leaf> leaves;
  std::vector<bool> leads_on(robot.joints.size(), false);  // to a joint beyond it
  for (const Reach& reach : leavesBelow(robot, root)) {
    Joints above = jointsAbove(robot, reach.link);
    above.resize(reach.joints);  // below root
    const auto moves_itself = [&](std::size_t j) {
      return isMovable(robot.joints[j]) &&
             !(options.locked_position && options.locked_position(robot.joints[j].name));
    };
    const auto moves = [&](std::size_t j) {
      return moves_itself(j) && moves_itself(leaderOf(robot, j).joint);
    };
    const auto last = std::find_if(above.begin(), above.end(), moves);
    if (last == above.end()) continue;
    std::for_each(last + 1, above.end(), [&](std::size_t j) { leads_on[j] = true; });
    const std::size_t joint = *last;
    leaves.push_back({reach.link, joint, std::move(above)});
  }
  std::vector<std::size_t> chosen;
  for (const Leaf& leaf : leaves) {
    const bool farthest = std::none_of(leaves.begin(), leaves.end(), [&](const Leaf& other) {
      return other.last == leaf.last &&
             (other.above.size() > leaf.above.size() ||
              (other.above.size() == leaf.above.size() && other.link < leaf.link));
    });
    if (farthest && !leads_on[leaf.last]) chosen.push_back(leaf.link);
  }
  std::sort(chosen.begin(), chosen.end());
  if (chosen.empty()) {
    throw ModelError(where(robot), "tip", "a leaf that a joint moves",
                     "none below '" + robot.links[root].name + "'", "choose another root");
  }
  return chosen;
}

std::vector<std::size_t> tipLinks(const RobotDescription& robot, const UrdfOptions& options,
                                  std::size_t root, const std::vector<std::string>& tips) {
  if (tips.empty()) return {leafBelow(robot, root)};
  if (tips.size() == 1 && tips[0] == "*") return movedLeaves(robot, options, root);
  std::vector<std::size_t> links;
  for (const std::string& tip : tips) {
    const std::size_t link = linkNamed(robot, tip, "tip");
    if (std::find(links.begin(), links.end(), link) != links.end()) {
      throw ModelError(where(robot), "tip", "each link once", "'" + tip + "' twice", "");
    }
    links.push_back(link);
  }
  return links;
}

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

/// Adds the texts that aren't there.
void addNew(std::vector<std::string>& texts, const std::vector<std::string>& more) {
  for (const std::string& text : more) {
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
}

Family familyOf(const RobotDescription& robot, const UrdfOptions& options,
                const std::vector<Path>& paths, bool mimics) {
  return {LockedJoints(robot, options, paths), mimics,
          std::vector<bool>(robot.links.size(), false)};
}

}  // namespace

Chain chainFromRobot(const RobotDescription& robot, const UrdfOptions& options) {
  const std::size_t root = rootOf(robot, options);
  const std::size_t tip =
      options.tip.empty() ? leafBelow(robot, root) : linkNamed(robot, options.tip, "tip");
  Family family = familyOf(robot, options, {pathBetween(robot, root, tip)}, false);
  Builder builder(robot, options, root, tip, family);
  const Chain chain = builder.chain();
  return chain.withWarnings(builder.warnings(chain));
}

Chain chainFromUrdf(const std::string& urdf_xml, const UrdfOptions& options) {
  return chainFromRobot(robotFromUrdf(urdf_xml), options);
}

Mechanism mechanismFromRobot(const RobotDescription& robot, const UrdfOptions& options,
                             const std::vector<std::string>& tips, bool branches_of_chains) {
  const std::size_t root = rootOf(robot, options);
  const std::vector<std::size_t> links = tipLinks(robot, options, root, tips);
  std::vector<Path> paths;
  paths.reserve(links.size());
  for (const std::size_t link : links) paths.push_back(pathBetween(robot, root, link));
  const auto mimics = [&robot](const Step& step) {
    const RobotDescription::Joint& joint = robot.joints[step.joint];
    return isMovable(joint) && joint.mimic;
  };
  if (!branches_of_chains && links.size() == 1 &&
      std::none_of(paths[0].begin(), paths[0].end(), mimics)) {
    UrdfOptions one = options;
    one.tip = robot.links[links[0]].name;
    return {chainFromRobot(robot, one), {}, {}, one.tip};
  }

  Family family = familyOf(robot, options, paths, true);
  for (const Path& path : paths) {
    for (const Step& step : path) family.locked.checkLeader(step.joint);
  }
  Coordinates coordinates(robot, family.locked);
  std::vector<Builder> builders;
  std::vector<Chain> chains;
  std::vector<Branch> branches;
  for (const std::size_t link : links) {
    builders.emplace_back(robot, options, root, link, family);
    chains.push_back(builders.back().chain());
    branches.push_back(coordinates.branch(robot.links[link].name, builders.back().ownPart()));
  }
  for (const bool follow : {false, true}) {
    for (const Branch& branch : branches) coordinates.take(branch.chain, follow);
  }
  std::vector<std::string> warnings;
  for (std::size_t b = 0; b < builders.size(); ++b)
    addNew(warnings, builders[b].warnings(chains[b]));
  addNew(warnings, coordinates.warnings());
  Mechanism mechanism{
      coordinates.chain(options.gravity.value_or(kDown)).withWarnings(std::move(warnings)),
      std::move(branches)};
  checkMechanism(mechanism);
  return mechanism;
}

std::vector<std::string> tipsNamed(const RobotDescription& robot, const std::string& text) {
  if (text.empty()) return {};
  if (robot.linkIndex(text) != kNone) return {text};  // whatever its name
  std::vector<std::string> tips;
  std::istringstream parts(text);
  for (std::string tip; std::getline(parts, tip, ',');) {
    const std::size_t first = tip.find_first_not_of(' ');
    const std::size_t last = tip.find_last_not_of(' ');
    tips.push_back(first == std::string::npos ? "" : tip.substr(first, last - first + 1));
  }
  return tips;
}

Mechanism mechanismFromUrdf(const std::string& urdf_xml, const UrdfOptions& options) {
  const RobotDescription robot = robotFromUrdf(urdf_xml);
  return mechanismFromRobot(robot, options, tipsNamed(robot, options.tip));
}

}  // namespace v2
}  // namespace chain_dynamics
