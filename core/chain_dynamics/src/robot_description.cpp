// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/robot_description.hpp"

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/text.hpp"
#include "number.hpp"
#include "urdf_element.hpp"
#include "urdf_transmissions.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using tinyxml2::XMLElement;
using Inertial = RobotDescription::Inertial;
using Link = RobotDescription::Link;
using Mimic = RobotDescription::Mimic;
using Type = RobotDescription::JointType;

// ---------------------------------------------------------------------------------------------
// What a URDF may hold

const Vocabulary kRobot{{"link", "joint"},
                        {"name", "version"},
                        {"gazebo", "material", "mujoco", "ros2_control", "sensor", "transmission"}};
const Vocabulary kLink{
    {"inertial"},
    {"name"},
    {"collision", "contact", "gazebo", "material", "self_collision_checking", "sensor", "visual"},
    {"type"}};
const Vocabulary kInertial{{"origin", "mass", "inertia"}, {}};
const Vocabulary kJoint{{"parent", "child", "origin", "axis", "limit", "mimic", "dynamics"},
                        {"name", "type"},
                        {"calibration", "gazebo", "safety_controller", "transmission"}};
const Vocabulary kOrigin{{}, {"xyz", "rpy", "quat_xyzw"}};
const Vocabulary kMass{{}, {"value"}};
const Vocabulary kInertia{{}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}};
const Vocabulary kEnd{{}, {"link"}};
const Vocabulary kAxis{{}, {"xyz"}};
const Vocabulary kLimit{
    {}, {"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"}};
const Vocabulary kMimic{{}, {"joint", "multiplier", "offset"}};
const Vocabulary kDynamics{{}, {"damping", "friction"}};

// ---------------------------------------------------------------------------------------------
// Numbers beyond what a robot can be

// At 1e6 m a double is exact to 1e-10 m, and 1 m of lever arm still has ten digits.
constexpr double kFarthest = 1e6;
constexpr double kHeaviest = 1e9;
constexpr double kGreatestMoment = 1e15;  // of the heaviest, 1 km wide
constexpr double kTwoTurns = 12.6;        // more is probably given in degrees

// ---------------------------------------------------------------------------------------------
// Parts of links and joints

Matrix3<double> rotation(const UrdfElement& origin) {
  if (!origin.hasSince("1.1", "quat_xyzw")) {
    const Eigen::Vector3d rpy =
        origin.has("rpy") ? origin.vector("rpy") : Eigen::Vector3d(Eigen::Vector3d::Zero());
    origin.checkSize("<origin> rpy", rpy.cwiseAbs().maxCoeff(), kTwoTurns, "rad");
    return rotationFromRollPitchYaw(rpy);
  }
  if (origin.has("rpy")) throw origin.error("<origin>", "either rpy or quat_xyzw", "both");
  const std::vector<double> xyzw = origin.numbers("quat_xyzw", 4);
  const Eigen::Vector4d quaternion =
      Eigen::Vector4d(xyzw.data()).stableNormalized();  // in the order of Eigen's coefficients
  if (quaternion.isZero(0)) {
    throw origin.error("<origin> quat_xyzw", "a rotation", "the zero quaternion",
                       "for example 0 0 0 1");
  }
  return Eigen::Quaterniond(quaternion).toRotationMatrix();
}

/// `<origin>`, with URDF's defaults for what is left out.
Transform<double> placement(const UrdfElement& parent) {
  auto X = Transform<double>::identity();
  if (const auto origin = parent.child("origin")) {
    origin->reportUnknown(kOrigin);
    X.R = rotation(*origin);
    if (origin->has("xyz")) {
      X.p = origin->vector("xyz");
      origin->checkSize("<origin> xyz", X.p.cwiseAbs().maxCoeff(), kFarthest, "m");
    }
  }
  return X;
}

/// Roll, pitch and yaw of an `<origin>`, whose rotation is R, as stated.
Eigen::Vector3d anglesOf(const UrdfElement& joint, const Matrix3<double>& R) {
  const auto origin = joint.child("origin");
  if (origin && origin->has("rpy")) return origin->vector("rpy");
  if (origin && origin->has("quat_xyzw")) return rollPitchYaw(R);
  return Eigen::Vector3d::Zero();
}

Matrix3<double> momentOfInertia(const UrdfElement& inertia) {
  inertia.reportUnknown(kInertia);
  const auto read = [&inertia](const char* key) {
    const double value = inertia.number(key);
    inertia.checkSize("<inertia> " + std::string(key), value, kGreatestMoment, "kg m^2");
    return value;
  };
  const double ixx = read("ixx"), ixy = read("ixy"), ixz = read("ixz");
  const double iyy = read("iyy"), iyz = read("iyz"), izz = read("izz");
  return (Matrix3<double>() << ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz).finished();
}

Inertial inertial(const UrdfElement& element) {
  element.reportUnknown(kInertial);
  Inertial result;
  result.line = element.line();
  result.placement = placement(element);

  const UrdfElement mass = element.requiredChild("mass", "leave out <inertial> for no mass");
  mass.reportUnknown(kMass);
  result.mass = mass.number("value");
  if (result.mass < 0) throw mass.error("mass", "a number >= 0 [kg]", mass.text("value"));
  mass.checkSize("<mass> value", result.mass, kHeaviest, "kg");
  result.inertia =
      momentOfInertia(element.requiredChild("inertia", "leave out <inertial> for no mass"));
  return result;
}

Type jointType(const UrdfElement& element) {
  static const std::map<std::string, Type> kTypes{
      {"fixed", Type::kFixed},         {"revolute", Type::kRevolute},
      {"prismatic", Type::kPrismatic}, {"continuous", Type::kContinuous},
      {"planar", Type::kPlanar},       {"floating", Type::kFloating}};
  const std::string type = element.text("type");
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) {
    throw element.error("type", "revolute, continuous, prismatic or fixed", "'" + type + "'");
  }
  return found->second;
}

void readAxis(const UrdfElement& element, RobotDescription::Joint& joint) {
  if (const auto axis = element.child("axis")) {
    axis->reportUnknown(kAxis);
    joint.axis = axis->vector("xyz");
    if (joint.axis.isZero(0)) {
      throw axis->error("<axis> xyz", "a direction", "the zero vector", "for example 0 0 1");
    }
  }
}

// A limit; none where it is 0, as exporters write of what isn't known, or below: some write -1.
double greatest(const UrdfElement& limit, const char* key) {
  const double value = limit.number(key);
  if (value > 0) return value;
  if (value != 0) {
    limit.warn("<limit> " + std::string(key) + ": " + limit.text(key) +
               " is taken as no limit; state the limit, or 0 where it is unknown");
  }
  return std::numeric_limits<double>::infinity();
}

void readLimits(const UrdfElement& element, RobotDescription::Joint& joint) {
  const bool needed = joint.type == Type::kRevolute || joint.type == Type::kPrismatic;
  const auto limit =
      needed ? element.requiredChild("limit", "a joint without limits is of type continuous")
             : element.child("limit");
  if (!limit) return;
  limit->reportUnknown(kLimit);
  joint.limits.effort = greatest(*limit, "effort");
  joint.limits.velocity = greatest(*limit, "velocity");
  for (const auto& [key, value] : {std::pair("acceleration", &joint.limits.acceleration),
                                   std::pair("deceleration", &joint.limits.deceleration),
                                   std::pair("jerk", &joint.limits.jerk)}) {
    if (limit->hasSince("1.2", key)) *value = greatest(*limit, key);
  }
  const double lower = limit->number("lower", 0);
  const double upper = limit->number("upper", 0);
  const bool stated = lower != 0 || upper != 0;
  if (joint.type != Type::kContinuous && stated) {
    joint.limits.lower = lower;
    joint.limits.upper = upper;
  }
}

void readDynamics(const UrdfElement& element, RobotDescription::Joint& joint) {
  if (const auto dynamics = element.child("dynamics")) {
    dynamics->reportUnknown(kDynamics);
    joint.damping = dynamics->number("damping", 0);
    joint.friction = dynamics->number("friction", 0);
    if (joint.damping < 0 || joint.friction < 0) {
      dynamics->warn("<dynamics>: negative damping or friction drives the joint");
    }
  }
}

// ---------------------------------------------------------------------------------------------
// Links and joints

/// Reads elements one by one, then joins them to a tree.
class Reader {
 public:
  RobotDescription read(const XMLElement& root) {
    UrdfElement robot(root, "robot", findings_);
    robot_.name = nameOf(robot);
    checkVersion(robot);
    robot.reportUnknown(kRobot);
    readLinks(root);
    readJoints(root);
    if (robot_.links.empty()) {
      throw robot.error("<robot>", "at least one <link>", "none",
                        findings_.hasXacro() ? "expand the file with xacro first" : "give a URDF");
    }
    connect();
    checkOneRoot(robot);
    checkNoLoop();
    readRotorInertia(root, robot_, findings_);
    readRos2Control(root, robot_, findings_);
    robot_.warnings = findings_.texts();
    return std::move(robot_);
  }

 private:
  /// Links or joints by their names.
  using Names = std::map<std::string, std::size_t>;

  static std::string nameOf(const UrdfElement& element) {
    std::string name = element.text("name");
    if (name.empty()) {
      throw ModelError("URDF:" + std::to_string(element.line()), element.tag() + " name", "a name",
                       "an empty text", "");
    }
    if (!isPrintable(name)) {
      throw element.error("name", "UTF-8 text without control characters", "'" + name + "'");
    }
    return name;
  }

  static void checkVersion(const UrdfElement& robot) {
    if (!robot.has("version")) return;
    const std::string version = robot.text("version");
    const auto number = finiteNumber(version);
    if (number != 1.0 && number != 1.1 && number != 1.2) {
      throw robot.error("<robot> version", "1.0, 1.1 or 1.2", "'" + version + "'");
    }
  }

  /// The element of an item, called by its name; the name is new.
  UrdfElement named(const XMLElement& element, Names& names) {
    const std::string kind = element.Name();
    const std::string name = nameOf(UrdfElement(element, kind, findings_));
    UrdfElement item(element, kind + " " + name, findings_);
    const auto [first, inserted] = names.emplace(name, names.size());
    if (!inserted) {
      const int line =
          kind == "link" ? robot_.links[first->second].line : robot_.joints[first->second].line;
      throw item.error("name", "a name of its own", "the one of line " + std::to_string(line),
                       "rename one of them");
    }
    return item;
  }

  void readLinks(const XMLElement& root) {
    for (const XMLElement* const next : childrenOf(root, "link")) {
      const UrdfElement element = named(*next, links_);
      element.reportUnknown(kLink);
      Link link;
      link.name = next->Attribute("name");
      link.line = element.line();
      if (const auto body = element.child("inertial")) link.inertial = inertial(*body);
      robot_.links.push_back(std::move(link));
    }
  }

  void readJoints(const XMLElement& root) {
    for (const XMLElement* const next : childrenOf(root, "joint")) {
      const UrdfElement element = named(*next, joints_);
      element.reportUnknown(kJoint);
      RobotDescription::Joint joint;
      joint.name = next->Attribute("name");
      joint.line = element.line();
      joint.type = jointType(element);
      joint.placement = placement(element);
      joint.rpy = anglesOf(element, joint.placement.R);
      joint.parent = linkAt(element, "parent");
      joint.child = linkAt(element, "child");
      if (isMovable(joint)) {
        readAxis(element, joint);
        readLimits(element, joint);
        readDynamics(element, joint);
      }
      robot_.joints.push_back(std::move(joint));
      elements_.push_back(element);
    }
  }

  /// The link that `<parent>` or `<child>` names.
  std::size_t linkAt(const UrdfElement& joint, const char* tag) const {
    const UrdfElement end = joint.requiredChild(tag, "");
    end.reportUnknown(kEnd);
    return find(end, end.tag(), end.text("link"), links_, "link");
  }

  static std::size_t find(const UrdfElement& element, const std::string& what,
                          const std::string& name, const Names& names, const std::string& kind) {
    const auto found = names.find(name);
    if (found != names.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& entry : names) known.push_back(entry.first);
    const std::string similar = nearestName(name, known);
    throw element.error(
        what, "a " + kind + " of the robot", "'" + name + "'",
        similar.empty() ? "define it, or correct the name" : "did you mean " + similar + "?");
  }

  // -------------------------------------------------------------------------------------------
  // The tree

  void connect() {
    for (const auto& [name, index] : joints_) {
      robot_.links[robot_.joints[index].parent].child_joints.push_back(index);
    }
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      Link& child = robot_.links[robot_.joints[j].child];
      if (child.parent_joint != RobotDescription::kNone) {
        throw elements_[j].error("<child>", "a link without another parent",
                                 "'" + child.name + "', which has one",
                                 "a robot is a tree of links");
      }
      child.parent_joint = j;
      if (isMovable(robot_.joints[j])) readMimic(j);
    }
  }

  void readMimic(std::size_t j) {
    if (const auto element = elements_[j].child("mimic")) {
      element->reportUnknown(kMimic);
      Mimic mimic;
      mimic.joint = find(*element, "<mimic> joint", element->text("joint"), joints_, "joint");
      mimic.multiplier = element->number("multiplier", 1);
      mimic.offset = element->number("offset", 0);
      robot_.joints[j].mimic = mimic;
    }
  }

  void checkOneRoot(const UrdfElement& robot) {
    std::vector<std::string> roots;
    for (const auto& [name, index] : links_) {
      if (robot_.links[index].parent_joint == RobotDescription::kNone) {
        roots.push_back(name);
        robot_.root = index;
      }
    }
    if (roots.size() != 1) {
      throw ModelError(
          "URDF:" + std::to_string(robot.line()), "root", "one link that is no joint's child",
          std::to_string(roots.size()) + (roots.empty() ? "" : ": ") + joined(roots),
          roots.empty() ? "remove the joint that closes a loop" : "join them by fixed joints");
    }
  }

  /// With one parent each, a link that isn't below the root is in a loop, or below one.
  void checkNoLoop() const {
    std::vector<bool> below(robot_.links.size(), false);
    for (const std::size_t link : robot_.linksBelow(robot_.root)) below[link] = true;
    for (const auto& [name, index] : links_) {
      if (!below[index]) {
        throw ModelError("URDF:" + std::to_string(robot_.links[index].line) + ": link " + name,
                         "place in the tree", "a way to the root", "a loop of joints",
                         "a serial chain can't be taken from a closed loop");
      }
    }
  }

  RobotDescription robot_;
  Findings findings_;
  std::vector<UrdfElement> elements_;  // of the joints
  Names links_;
  Names joints_;
};

// ---------------------------------------------------------------------------------------------
// The text

/// Whether a text is one word with the ending of a description: a file name, not its text.
bool isFileName(const std::string& text) {
  const std::size_t point = text.rfind('.');
  const std::string ending = point == std::string::npos ? "" : text.substr(point);
  return (ending == ".urdf" || ending == ".xacro" || ending == ".xml") &&
         text.find_first_of("\r\n") == std::string::npos;
}

/// What can be said without the parser; nothing of a text that isn't XML is quoted: it may be
/// anyone's secret.
void checkText(const std::string& text) {
  constexpr std::size_t kLongest = 64U << 20U;
  if (text.size() > kLongest) {
    throw ModelError("URDF", "robot description", "at most 64 MiB",
                     std::to_string(text.size()) + " bytes", "give a URDF");
  }
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(zero), '\n');
    throw ModelError("URDF:" + std::to_string(line), "robot description", "XML in UTF-8",
                     "a byte 0", "save it as UTF-8");
  }
  const std::size_t mark = text.rfind("\xEF\xBB\xBF", 0) == 0 ? 3 : 0;
  const std::size_t start = text.find_first_not_of(" \t\r\n", mark);
  if (start == std::string::npos) {
    throw ModelError("URDF", "robot description", "the text of a URDF", "an empty text",
                     "give the robot's URDF");
  }
  if (text[start] != '<') {
    throw ModelError("URDF:1", "robot description", "XML",
                     isFileName(text) ? "'" + text + "'" : "a text that doesn't start with '<'",
                     "give the text of the URDF, not its file name");
  }
}

/// What follows the root element, where tinyxml2 takes anything.
void checkNothingAfter(const XMLElement& root) {
  for (auto* next = root.NextSibling(); next != nullptr; next = next->NextSibling()) {
    if (next->ToElement() != nullptr || next->ToText() != nullptr) {
      throw ModelError(
          "URDF:" + std::to_string(next->GetLineNum()), "robot description",
          "nothing after </" + std::string(root.Name()) + ">",
          next->ToText() != nullptr ? "text" : "<" + std::string(next->ToElement()->Name()) + ">",
          "remove it");
    }
  }
}

const XMLElement& rootElement(tinyxml2::XMLDocument& document, const std::string& text) {
  checkText(text);
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS ||
      document.RootElement() == nullptr) {
    throw ModelError("URDF:" + std::to_string(document.ErrorLineNum()), "robot description",
                     "well-formed XML", document.ErrorName(), "is the text cut off?");
  }
  const XMLElement& root = *document.RootElement();
  if (std::string(root.Name()) != "robot") {
    throw ModelError("URDF:" + std::to_string(root.GetLineNum()), "robot description", "<robot>",
                     "<" + std::string(root.Name()) + ">", "give a URDF");
  }
  checkNothingAfter(root);
  return root;
}

template <typename Item>
std::size_t indexOf(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(),
                                  [&name](const Item& item) { return item.name == name; });
  return found == items.end() ? RobotDescription::kNone
                              : static_cast<std::size_t>(found - items.begin());
}

}  // namespace

std::size_t RobotDescription::linkIndex(const std::string& link) const {
  return indexOf(links, link);
}

std::size_t RobotDescription::jointIndex(const std::string& joint) const {
  return indexOf(joints, joint);
}

std::vector<std::size_t> RobotDescription::linksBelow(std::size_t link) const {
  std::vector<std::size_t> below;
  std::vector<std::size_t> open{link};
  while (!open.empty()) {
    below.push_back(open.back());
    open.pop_back();
    // from the back, so that the first child is taken next
    const std::vector<std::size_t>& children = links[below.back()].child_joints;
    for (auto next = children.rbegin(); next != children.rend(); ++next) {
      open.push_back(joints[*next].child);
    }
  }
  return below;
}

RobotDescription robotFromUrdf(const std::string& urdf_xml) {
  tinyxml2::XMLDocument document;
  return Reader().read(rootElement(document, urdf_xml));
}

}  // namespace v2
}  // namespace chain_dynamics
