// SPDX-License-Identifier: Apache-2.0

#include "urdf_transmissions.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstddef>
#include <optional>
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

}  // namespace v2
}  // namespace chain_dynamics
