// SPDX-License-Identifier: Apache-2.0

#include "urdf_check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "number.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using tinyxml2::XMLElement;

const std::set<std::string> kJointTypes{"revolute", "continuous", "prismatic",
                                        "fixed",    "planar",     "floating"};

std::string line(const XMLElement& element) {
  return "URDF:" + std::to_string(element.GetLineNum());
}

std::vector<XMLElement*> children(XMLElement& parent, const char* tag) {
  std::vector<XMLElement*> result;
  for (auto* child = parent.FirstChildElement(tag); child != nullptr;
       child = child->NextSiblingElement(tag)) {
    result.push_back(child);
  }
  return result;
}

// Reads one <link> or <joint>: knows how to name it in messages.
class Item {
 public:
  explicit Item(XMLElement& element) : element_(element) {
    name_ = attribute(element, "name");
    if (name_.empty()) {
      throw ModelError(line(element), tag(element) + " name", "a name", "an empty text", "");
    }
  }

  XMLElement& element() const { return element_; }
  const std::string& name() const { return name_; }
  std::string kind() const { return element_.Name(); }

  // `URDF:12: joint elbow`, the line that of the element at fault.
  std::string where(const XMLElement& at) const {
    return line(at) + ": " + kind() + (name_.empty() ? "" : " " + name_);
  }

  static std::string tag(const XMLElement& element) {
    return "<" + std::string(element.Name()) + ">";
  }

  std::string attribute(const XMLElement& at, const char* key) const {
    const char* value = at.Attribute(key);
    if (value == nullptr) {
      throw ModelError(where(at), tag(at), "attribute '" + std::string(key) + "'", "none", "");
    }
    return value;
  }

  double number(const XMLElement& at, const char* key) const {
    const std::string text = attribute(at, key);
    const auto value = finiteNumber(text);
    if (!value) {
      throw ModelError(where(at), tag(at) + " " + key, "a finite number", "'" + text + "'",
                       "write it with a decimal point");
    }
    return *value;
  }

  void optionalNumber(const XMLElement& at, const char* key) const {
    if (at.Attribute(key) != nullptr) {
      number(at, key);
    }
  }

  std::array<double, 3> vector(const XMLElement& at, const char* key) const {
    const std::string text = attribute(at, key);
    std::istringstream stream(text);
    std::vector<double> values;
    for (std::string word; stream >> word;) {
      const auto value = finiteNumber(word);
      if (!value) {
        throw ModelError(where(at), tag(at) + " " + key, "three finite numbers", "'" + text + "'",
                         "separate them by blanks");
      }
      values.push_back(*value);
    }
    if (values.size() != 3) {
      throw ModelError(where(at), tag(at) + " " + key, "three finite numbers",
                       std::to_string(values.size()) + " in '" + text + "'", "");
    }
    return {values[0], values[1], values[2]};
  }

  // The one child of that tag, or null.
  XMLElement* optionalChild(XMLElement& parent, const char* child_tag) const {
    const auto found = children(parent, child_tag);
    if (found.size() > 1) {
      throw ModelError(where(*found[1]), "<" + std::string(child_tag) + ">", "at most one",
                       std::to_string(found.size()), "");
    }
    return found.empty() ? nullptr : found[0];
  }

  XMLElement& child(XMLElement& parent, const char* child_tag, const std::string& remedy) const {
    XMLElement* found = optionalChild(parent, child_tag);
    if (found == nullptr) {
      throw ModelError(where(parent), tag(parent), "<" + std::string(child_tag) + ">", "none",
                       remedy);
    }
    return *found;
  }

  // <origin>, with URDF's defaults for what is left out.
  void checkOrigin(XMLElement& parent) const {
    if (const XMLElement* origin = optionalChild(parent, "origin")) {
      for (const char* key : {"xyz", "rpy"}) {
        if (origin->Attribute(key) != nullptr) {
          vector(*origin, key);
        }
      }
    }
  }

  // Removes the children whose tag isn't in the list.
  void keepOnly(const std::set<std::string>& tags) {
    for (auto* next = element_.FirstChildElement(); next != nullptr;) {
      auto* current = next;
      next = next->NextSiblingElement();
      if (tags.count(current->Name()) == 0) {
        element_.DeleteChild(current);
      }
    }
  }

 private:
  XMLElement& element_;
  std::string name_;
};

void checkLink(Item& link) {
  link.keepOnly({"inertial"});
  XMLElement* inertial = link.optionalChild(link.element(), "inertial");
  if (inertial == nullptr) {
    return;
  }
  link.checkOrigin(*inertial);

  const XMLElement& mass = link.child(*inertial, "mass", "leave out <inertial> for no mass");
  if (link.number(mass, "value") < 0) {
    throw ModelError(link.where(mass), "mass", "a number >= 0 [kg]", mass.Attribute("value"), "");
  }
  const XMLElement& inertia = link.child(*inertial, "inertia", "leave out <inertial> for no mass");
  for (const char* key : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
    link.number(inertia, key);
  }
}

void checkLimit(const Item& joint, const std::string& type) {
  if (type == "revolute" || type == "prismatic") {
    joint.child(joint.element(), "limit", "a joint without limits is of type continuous");
  }
  if (const XMLElement* limit = joint.optionalChild(joint.element(), "limit")) {
    joint.number(*limit, "effort");
    joint.number(*limit, "velocity");
    joint.optionalNumber(*limit, "lower");
    joint.optionalNumber(*limit, "upper");
  }
}

void checkAxis(const Item& joint) {
  if (const XMLElement* axis = joint.optionalChild(joint.element(), "axis")) {
    const auto xyz = joint.vector(*axis, "xyz");
    if (std::all_of(xyz.begin(), xyz.end(), [](double value) { return value == 0; })) {
      throw ModelError(joint.where(*axis), "<axis> xyz", "a direction", "the zero vector",
                       "for example 0 0 1");
    }
  }
}

void checkJoint(Item& joint) {
  const std::string type = joint.attribute(joint.element(), "type");
  if (kJointTypes.count(type) == 0) {
    throw ModelError(joint.where(joint.element()), "type",
                     "revolute, continuous, prismatic or fixed", "'" + type + "'", "");
  }
  const bool fixed = type == "fixed";
  joint.keepOnly(fixed ? std::set<std::string>{"parent", "child", "origin"}
                       : std::set<std::string>{"parent", "child", "origin", "axis", "limit",
                                               "mimic", "dynamics"});
  joint.checkOrigin(joint.element());
  if (fixed) {
    return;
  }
  checkAxis(joint);
  checkLimit(joint, type);
  if (const XMLElement* mimic = joint.optionalChild(joint.element(), "mimic")) {
    joint.attribute(*mimic, "joint");
    joint.optionalNumber(*mimic, "multiplier");
    joint.optionalNumber(*mimic, "offset");
  }
  if (XMLElement* dynamics = joint.optionalChild(joint.element(), "dynamics")) {
    joint.optionalNumber(*dynamics, "damping");
    joint.optionalNumber(*dynamics, "friction");
    if (dynamics->Attribute("damping") == nullptr && dynamics->Attribute("friction") == nullptr) {
      joint.element().DeleteChild(dynamics);  // urdfdom would refuse the robot
    }
  }
}

// The links and joints of a robot as a tree.
class Tree {
 public:
  Tree(const std::vector<Item>& links, const std::vector<Item>& joints) {
    unique(links, links_);
    unique(joints, joints_);
    for (const Item& joint : joints) {
      addJoint(joint);
    }
  }

  void checkOneRoot(const XMLElement& robot) const {
    std::vector<std::string> roots;
    for (const auto& [name, item] : links_) {
      if (parent_.count(name) == 0) {
        roots.push_back(name);
      }
    }
    if (roots.size() != 1) {
      std::string names;
      for (const std::string& name : roots) {
        names += (names.empty() ? ": " : ", ") + name;
      }
      throw ModelError(line(robot), "root", "one link that is no joint's child",
                       std::to_string(roots.size()) + names, "join them by fixed joints");
    }
  }

  // With one parent each, a link that never gets to a root is in a loop.
  void checkNoLoop() const {
    for (const auto& [name, item] : links_) {
      std::string ancestor = name;
      std::size_t steps = 0;
      while (parent_.count(ancestor) != 0 && steps++ <= links_.size()) {
        ancestor = parent_.at(ancestor);
      }
      if (parent_.count(ancestor) != 0) {
        throw ModelError(item->where(item->element()), "place in the tree", "a way to the root",
                         "a loop of joints", "a serial chain can't be taken from a closed loop");
      }
    }
  }

 private:
  using Names = std::map<std::string, const Item*>;

  static void unique(const std::vector<Item>& items, Names& names) {
    for (const Item& item : items) {
      const auto [first, inserted] = names.emplace(item.name(), &item);
      if (!inserted) {
        throw ModelError(item.where(item.element()), "name", "a name of its own",
                         "the one of line " + std::to_string(first->second->element().GetLineNum()),
                         "rename one of them");
      }
    }
  }

  void addJoint(const Item& joint) {
    const std::string parent = linkOf(joint, "parent");
    const std::string child = linkOf(joint, "child");
    if (!parent_.emplace(child, parent).second) {
      throw ModelError(joint.where(joint.element()), "<child>", "a link without another parent",
                       "'" + child + "', which has one", "a robot is a tree of links");
    }
    if (XMLElement* mimic = joint.optionalChild(joint.element(), "mimic")) {
      const std::string source = joint.attribute(*mimic, "joint");
      if (joints_.count(source) == 0) {
        throw ModelError(joint.where(*mimic), "<mimic> joint", "a joint of the robot",
                         "'" + source + "'", "");
      }
    }
  }

  std::string linkOf(const Item& joint, const char* tag) const {
    const XMLElement& end = joint.child(joint.element(), tag, "");
    std::string name = joint.attribute(end, "link");
    if (links_.count(name) == 0) {
      throw ModelError(joint.where(end), Item::tag(end), "a link of the robot", "'" + name + "'",
                       "define it, or correct the name");
    }
    return name;
  }

  Names links_;
  Names joints_;
  std::map<std::string, std::string> parent_;  // of each link but the root
};

void checkXacroExpanded(const XMLElement& robot) {
  for (const auto* child = robot.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (std::string(child->Name()).rfind("xacro:", 0) == 0) {
      throw ModelError(line(*child), Item::tag(*child), "a URDF", "xacro macros",
                       "expand the file with xacro first");
    }
  }
}

// Why a text isn't XML, for the three usual reasons.
ModelError notXml(const std::string& text, const tinyxml2::XMLDocument& document) {
  const auto blank = [](unsigned char c) { return std::isspace(c) != 0; };
  const auto start = std::find_if_not(text.begin(), text.end(), blank);
  if (start == text.end()) {
    return {"URDF", "robot description", "the text of a URDF", "an empty text",
            "give the robot's URDF"};
  }
  if (*start != '<') {
    const auto excerpt = std::string(start, text.end()).substr(0, 40);
    return {"URDF:1", "robot description", "XML", "'" + excerpt + "'",
            "give the text of the URDF, not its file name"};
  }
  return {"URDF:" + std::to_string(document.ErrorLineNum()), "robot description", "well-formed XML",
          document.ErrorName(), "is the text cut off?"};
}

XMLElement& robotElement(tinyxml2::XMLDocument& document, const std::string& text) {
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS ||
      document.RootElement() == nullptr) {
    throw notXml(text, document);
  }
  XMLElement& robot = *document.RootElement();
  if (std::string(robot.Name()) != "robot") {
    throw ModelError(line(robot), "robot description", "<robot>", Item::tag(robot), "give a URDF");
  }
  return robot;
}

// Makes the items of one tag, in document order.
std::vector<Item> items(XMLElement& robot, const char* tag, void (*check)(Item&)) {
  std::vector<Item> result;
  for (XMLElement* element : children(robot, tag)) {
    result.emplace_back(*element);
    check(result.back());
  }
  return result;
}

}  // namespace

std::string checkedUrdf(const std::string& urdf_xml) {
  tinyxml2::XMLDocument document;
  XMLElement& robot = robotElement(document, urdf_xml);
  checkXacroExpanded(robot);
  Item(robot).keepOnly({"link", "joint"});

  const auto links = items(robot, "link", checkLink);
  const auto joints = items(robot, "joint", checkJoint);
  if (links.empty()) {
    throw ModelError(line(robot), "<robot>", "at least one <link>", "none", "give a URDF");
  }
  const Tree tree(links, joints);
  tree.checkOneRoot(robot);
  tree.checkNoLoop();

  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace v2
}  // namespace chain_dynamics
