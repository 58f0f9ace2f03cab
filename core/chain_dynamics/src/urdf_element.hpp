// SPDX-License-Identifier: Apache-2.0

/// @file
/// Elements of a URDF, read strictly, that know where they stand.
///
///     const auto mass = inertial.requiredChild("mass", "");
///     const double m = mass.number("value");   // URDF:12: link arm: <mass> value: expected ...
///     mass.reportUnknown({{}, {"value"}});     // a warning for every other name

#pragma once

#include <tinyxml2.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Warnings in the order in which they came up, and not too many of them.
class Findings {
 public:
  void add(const std::string& text);

  /// Only the first of a key is kept, with the number of those that follow.
  void addOnce(const std::string& key, const std::string& text);

  std::vector<std::string> texts() const;

  /// Whether what is added is only counted.
  bool isFull() const { return left_out_ > 0; }

  /// Whether an element of xacro is among them.
  bool hasXacro() const { return once_.count(kXacro) != 0; }
  static constexpr const char* kXacro = "xacro";

 private:
  struct Finding {
    std::string text;
    std::size_t more = 0;  // of the same key
  };

  std::vector<Finding> findings_;
  std::size_t left_out_ = 0;
  std::map<std::string, std::size_t> once_;  // place in findings_
};

/// The children of that tag, or all.
std::vector<const tinyxml2::XMLElement*> childrenOf(const tinyxml2::XMLElement& parent,
                                                    const char* tag = nullptr);

/// The names that an element may hold.
struct Vocabulary {
  std::vector<std::string> children;    // read
  std::vector<std::string> attributes;  // read
  std::vector<std::string> other_children = {};
  std::vector<std::string> other_attributes = {};
};

/// One element: the XML, and the link or joint that it belongs to.
class UrdfElement {
 public:
  /// @param item      what messages call the link or joint: `joint elbow`.
  /// @param findings  outlives the element.
  UrdfElement(const tinyxml2::XMLElement& element, std::string item, Findings& findings)
      : element_(&element), item_(std::move(item)), findings_(&findings) {}

  /// An attribute; its absence and a malformed number are errors, without a fallback.
  std::string text(const char* key) const;
  double number(const char* key) const;
  double number(const char* key, double fallback) const;
  std::vector<double> numbers(const char* key, std::size_t count) const;
  Eigen::Vector3d vector(const char* key) const;
  bool has(const char* key) const { return element_->Attribute(key) != nullptr; }
  /// Whether it has an attribute that URDF knows from this version on. A URDF that states an earlier
  /// version, or none, which is 1.0, hasn't, and a warning says so [urdfdom].
  bool hasSince(const char* version, const char* key) const;

  /// The child of that tag, of which there may be only one.
  std::optional<UrdfElement> child(const char* child_tag) const;
  UrdfElement requiredChild(const char* child_tag, const std::string& remedy) const;

  /// Warns of children, attributes and text that nothing reads. known: outlives the element.
  void reportUnknown(const Vocabulary& known) const;

  /// A number of a robot's size; beyond it a warning, and an error where products would overflow.
  void checkSize(const std::string& what, double value, double greatest,
                 const std::string& unit) const;

  /// `URDF:12: joint elbow: what: expected ..., got ...; remedy`, and a warning in the same style.
  ModelError error(const std::string& what, const std::string& expected, const std::string& got,
                   const std::string& remedy = "") const;
  void warn(const std::string& text) const { findings_->add(where() + ": " + text); }

  /// `URDF:12: joint elbow`.
  std::string where() const;
  /// `<mass>`.
  std::string tag() const { return "<" + std::string(element_->Name()) + ">"; }
  int line() const { return element_->GetLineNum(); }
  const std::string& item() const { return item_; }

 private:
  void reportAttributes(const Vocabulary& known) const;
  void reportChildren(const Vocabulary& known) const;
  void reportName(const std::string& at, const std::string& name, bool is_element,
                  const std::vector<std::string>& read,
                  const std::vector<std::string>& others) const;

  const tinyxml2::XMLElement* element_;
  std::string item_;
  Findings* findings_;
  mutable const Vocabulary* known_ = nullptr;  // after reportUnknown()
};

}  // namespace v2
}  // namespace chain_dynamics
