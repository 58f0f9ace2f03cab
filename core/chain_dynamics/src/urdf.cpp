// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/urdf.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/text.hpp"
#include "definite_inertia.hpp"
#include "locked_joints.hpp"
#include "plausibility.hpp"
#include "urdf_coordinates.hpp"
#include "urdf_paths.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using namespace paths;  // NOLINT(google-build-using-namespace)
using Link = RobotDescription::Link;
using Type = RobotDescription::JointType;

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
