// SPDX-License-Identifier: Apache-2.0

#include "urdf_transmissions.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "number.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using tinyxml2::XMLElement;

/// One transmission, in which ROS's tags and Drake's may state the same.
class Transmission {
 public:
  Transmission(const XMLElement& element, Findings& findings)
      : element_(element), findings_(findings) {
    const char* const name = element.Attribute("name");
    item_ = name == nullptr ? "transmission" : "transmission " + std::string(name);
  }

  /// Reflected to the joint: I ratio^2.
  double rotorInertia() const {
    const double inertia = stated({"motorInertia", "drake:rotor_inertia"}).value_or(0);
    const double ratio = stated({"mechanicalReduction", "drake:gear_ratio"}).value_or(1);
    const double reflected = inertia * ratio * ratio;
    if (!(inertia >= 0 && reflected <= kLargestNumber)) {
      throw at(element_).error("rotor inertia", "a number >= 0 [kg m^2]",
                               std::to_string(inertia) + ", reduction " + std::to_string(ratio));
    }
    return reflected;
  }

  /// The one joint that the motor turns.
  std::size_t joint(const RobotDescription& robot) const {
    for (const char* const part : {"joint", "actuator"}) {
      const std::size_t count = childrenOf(element_, part).size();
      if (count != 1) {
        throw at(element_).error("<" + std::string(part) + ">", "one", std::to_string(count));
      }
    }
    const UrdfElement joint = at(*element_.FirstChildElement("joint"));
    const std::size_t index = robot.jointIndex(joint.text("name"));
    if (index == RobotDescription::kNone) {
      throw joint.error("<joint> name", "a joint of the robot", "'" + joint.text("name") + "'");
    }
    return index;
  }

 private:
  UrdfElement at(const XMLElement& element) const { return {element, item_, findings_}; }

  /// The number by any of the names, on the transmission or on a part of it.
  std::optional<double> stated(const std::vector<std::string>& names) const {
    std::vector<const XMLElement*> elements = childrenOf(element_);
    for (const XMLElement* const part : childrenOf(element_)) {
      const auto below = childrenOf(*part);
      elements.insert(elements.end(), below.begin(), below.end());
    }
    std::optional<double> result;
    for (const XMLElement* const element : elements) {
      if (std::find(names.begin(), names.end(), element->Name()) == names.end()) continue;
      const UrdfElement where = at(*element);
      const std::string text = textOf(*element);
      const auto number = finiteNumber(text);
      if (!number) throw where.error(where.tag(), "a finite number", "'" + text + "'");
      if (result && *result != *number) {
        throw where.error(where.tag(), "the number stated before", "'" + text + "'");
      }
      result = number;
    }
    return result;
  }

  /// ROS writes a number as text, Drake as an attribute.
  static std::string textOf(const XMLElement& element) {
    const char* text = element.Attribute("value");
    if (text == nullptr) text = element.GetText();
    return text == nullptr ? "" : text;
  }

  const XMLElement& element_;
  Findings& findings_;
  std::string item_;
};

/// A transmission of ros2_control, as its package transmission_interface computes it.
class Ros2Transmission {
 public:
  Ros2Transmission(const XMLElement& element, Findings& findings)
      : element_(element), at_(element, itemOf(element), findings), findings_(findings) {}

  /// @param of_actuator  of a component of one actuator, which states none.
  RobotDescription::Transmission read(bool of_actuator) const {
    RobotDescription::Transmission result;
    result.name = element_.Attribute("name") == nullptr ? "" : element_.Attribute("name");
    result.line = at_.line();
    for (const XMLElement* const joint : childrenOf(element_, "joint")) {
      if (const char* const name = joint->Attribute("name")) result.joints.emplace_back(name);
    }
    try {
      readMatrix(of_actuator, result);
    } catch (const ModelError& error) {
      result.fault = error.what();
    }
    return result;
  }

 private:
  static std::string itemOf(const XMLElement& element) {
    const char* const name = element.Attribute("name");
    return name == nullptr ? "transmission" : "transmission " + std::string(name);
  }

  UrdfElement at(const XMLElement& element) const { return {element, at_.item(), findings_}; }

  /// The text of a child, without spaces around it; "" if there is none.
  static std::string textOf(const XMLElement& parent, const char* tag) {
    const XMLElement* const child = parent.FirstChildElement(tag);
    const std::string text =
        child == nullptr || child->GetText() == nullptr ? "" : child->GetText();
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first);
  }

  double number(const XMLElement& part, const char* tag, double fallback) const {
    const std::string text = textOf(part, tag);
    if (text.empty() && part.FirstChildElement(tag) == nullptr) return fallback;
    const auto number = finiteNumber(text);
    if (number) return *number;
    throw at(part).error("<" + std::string(tag) + ">", "a finite number", "'" + text + "'");
  }

  double reduction(const XMLElement& part) const {
    const double value = number(part, "mechanical_reduction", 1);
    if (value != 0) return value;
    throw at(part).error("<mechanical_reduction>", "a number other than 0", "0");
  }

  /// Joints or actuators, in the order of their roles.
  std::vector<const XMLElement*> parts(const char* tag, std::size_t count) const {
    const std::vector<const XMLElement*> found = childrenOf(element_, tag);
    if (found.size() != count) {
      throw at_.error("<" + std::string(tag) + ">", std::to_string(count),
                      std::to_string(found.size()));
    }
    std::set<std::string> names;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string name = at(*found[k]).text("name");
      if (!names.insert(name).second) {
        throw at(*found[k]).error("<" + std::string(tag) + "> name", "each once",
                                  "'" + name + "' twice");
      }
      const std::string expected = tag + std::to_string(k + 1);
      const char* const role = found[k]->Attribute("role");
      if (count == 1 || (role != nullptr && role == expected)) continue;
      throw at(*found[k]).error("<" + std::string(tag) + "> role", expected + ", in this order",
                                role == nullptr ? "none" : "'" + std::string(role) + "'");
    }
    return found;
  }

  void readMatrix(bool of_actuator, RobotDescription::Transmission& result) const {
    const std::string plugin = textOf(element_, "plugin");
    const bool simple = plugin == "transmission_interface/SimpleTransmission";
    const bool differential = plugin == "transmission_interface/DifferentialTransmission";
    if (!simple && !differential && plugin != "transmission_interface/FourBarLinkageTransmission") {
      throw at_.error(
          "<plugin>",
          "SimpleTransmission, DifferentialTransmission or FourBarLinkageTransmission of "
          "transmission_interface",
          plugin.empty() ? "none" : "'" + plugin + "'", "state the matrix by the parameter motors");
    }
    const std::size_t count = simple ? 1 : 2;
    std::vector<double> n_j, n_a;
    for (const XMLElement* const joint : parts("joint", count)) {
      n_j.push_back(reduction(*joint));
      result.offset.push_back(number(*joint, "offset", 0));
    }
    if (simple) {  // the reduction of its actuator is of no meaning to ros2_control
      result.M = {1 / n_j[0]};
      const bool unnamed = of_actuator && childrenOf(element_, "actuator").empty();
      result.motors = {unnamed ? result.joints[0] : parts("actuator", 1)[0]->Attribute("name")};
      return;
    }
    for (const XMLElement* const actuator : parts("actuator", count)) {
      n_a.push_back(reduction(*actuator));
      result.motors.emplace_back(actuator->Attribute("name"));
    }
    if (differential) {
      // half the sum and half the difference of what the motors turn
      result.M = {0.5 / (n_j[0] * n_a[0]), 0.5 / (n_j[0] * n_a[1]),  //
                  0.5 / (n_j[1] * n_a[0]), -0.5 / (n_j[1] * n_a[1])};
    } else {
      // the second motor turns its joint together with the first joint
      result.M = {1 / (n_j[0] * n_a[0]), 0,  //
                  -1 / (n_j[0] * n_a[0] * n_j[1]), 1 / (n_j[1] * n_a[1])};
    }
  }

  const XMLElement& element_;
  UrdfElement at_;
  Findings& findings_;
};

/// A joint with mimic="false" moves by itself.
void readMimicFalse(const XMLElement& element, RobotDescription& robot, Findings& findings) {
  if (element.Attribute("mimic") == nullptr || element.Attribute("name") == nullptr) return;
  const std::string name = element.Attribute("name");
  std::string mimic = element.Attribute("mimic");
  std::transform(mimic.begin(), mimic.end(), mimic.begin(),
                 [](char letter) { return letter >= 'A' && letter <= 'Z' ? letter + 32 : letter; });
  const std::size_t j = robot.jointIndex(name);
  if (mimic == "false" && j != RobotDescription::kNone) robot.joints[j].mimic.reset();
  if (mimic == "true" || mimic == "false") return;
  UrdfElement(element, "<ros2_control>: joint " + name, findings)
      .warn("mimic: expected true or false, got '" + mimic + "'; it isn't used");
}

}  // namespace

void readRotorInertia(const XMLElement& robot_element, RobotDescription& robot,
                      Findings& findings) {
  for (const XMLElement* const element : childrenOf(robot_element, "transmission")) {
    const Transmission transmission(*element, findings);
    try {
      const double inertia = transmission.rotorInertia();
      if (inertia > 0) robot.joints[transmission.joint(robot)].rotor_inertia += inertia;
    } catch (const ModelError& error) {
      findings.add(std::string(error.what()) + "; its rotor inertia isn't read");
    }
  }
}

void readRos2Control(const XMLElement& robot_element, RobotDescription& robot, Findings& findings) {
  for (const XMLElement* const component : childrenOf(robot_element, "ros2_control")) {
    for (const XMLElement* const joint : childrenOf(*component, "joint")) {
      readMimicFalse(*joint, robot, findings);
    }
    const char* const type = component->Attribute("type");
    const bool of_actuator = type != nullptr && std::string(type) == "actuator";
    for (const XMLElement* const transmission : childrenOf(*component, "transmission")) {
      robot.transmissions.push_back(Ros2Transmission(*transmission, findings).read(of_actuator));
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics
