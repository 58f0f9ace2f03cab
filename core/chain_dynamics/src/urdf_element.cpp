// SPDX-License-Identifier: Apache-2.0

#include "urdf_element.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chain_dynamics/text.hpp"
#include "number.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kMostFindings = 100;

const char* const kBlanks = " \t\r\n";

std::string place(int line) { return "URDF:" + std::to_string(line); }

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether a name is of another XML namespace, or declares one.
bool isOfNamespace(const std::string& name) {
  return name.find(':') != std::string::npos || name == "xmlns";
}

bool isXacro(const std::string& name) { return name.rfind("xacro:", 0) == 0; }

std::string quoted(const std::string& name, bool is_element) {
  return is_element ? "<" + name + ">" : name;
}

/// What to do about a text that isn't a number.
std::string remedyFor(const std::string& text, const std::string& otherwise) {
  const bool xacro = text.find("${") != std::string::npos || text.find("$(") != std::string::npos;
  return xacro ? "expand the file with xacro first" : otherwise;
}

}  // namespace

// ---------------------------------------------------------------------------------------------
// Findings

void Findings::add(const std::string& text) {
  if (findings_.size() == kMostFindings) {
    ++left_out_;
    return;
  }
  findings_.push_back({printable(text), 0});
}

void Findings::addOnce(const std::string& key, const std::string& text) {
  const auto [found, inserted] = once_.emplace(key, findings_.size());
  if (!inserted && found->second < findings_.size()) {
    ++findings_[found->second].more;
    return;
  }
  add(text);
}

std::vector<std::string> Findings::texts() const {
  std::vector<std::string> texts;
  for (const Finding& finding : findings_) {
    texts.push_back(finding.text);
    if (finding.more > 0) texts.back() += " (and " + std::to_string(finding.more) + " more)";
  }
  if (left_out_ > 0) {
    texts.push_back("URDF: " + std::to_string(left_out_) + " more warnings aren't listed");
  }
  return texts;
}

// ---------------------------------------------------------------------------------------------
// Errors

std::string UrdfElement::where() const { return place(line()) + ": " + item_; }

ModelError UrdfElement::error(const std::string& what, const std::string& expected,
                              const std::string& got, const std::string& remedy) const {
  return {where(), what, expected, got, remedy};
}

// ---------------------------------------------------------------------------------------------
// Attributes

std::string UrdfElement::text(const char* key) const {
  if (const char* value = element_->Attribute(key)) return value;
  std::vector<std::string> unknown;
  for (auto* other = element_->FirstAttribute(); other != nullptr; other = other->Next()) {
    if (known_ == nullptr || !contains(known_->attributes, other->Name())) {
      unknown.emplace_back(other->Name());
    }
  }
  const std::string similar = nearestName(key, unknown);
  throw error(tag(), "attribute '" + std::string(key) + "'", "none",
              similar.empty() ? "add it" : "is it misspelt as '" + similar + "'?");
}

bool UrdfElement::hasSince(const char* version, const char* key) const {
  if (!has(key)) return false;
  const char* const stated = element_->GetDocument()->RootElement()->Attribute("version");
  if (stated != nullptr && finiteNumber(stated) >= finiteNumber(version)) return true;
  findings_->addOnce(key, where() + ": " + tag() + " " + key + " is ignored: URDF knows it from " +
                              version + " on; state <robot version=\"" + version + "\">");
  return false;
}

double UrdfElement::number(const char* key) const {
  const std::string value = text(key);
  const auto number = finiteNumber(value);
  if (!number) {
    throw error(tag() + " " + key, "a finite number", "'" + value + "'",
                remedyFor(value, "write a finite number, with a decimal point and without a unit"));
  }
  return *number;
}

double UrdfElement::number(const char* key, double fallback) const {
  return has(key) ? number(key) : fallback;
}

std::vector<double> UrdfElement::numbers(const char* key, std::size_t count) const {
  const std::string expected =
      count == 3 ? "three finite numbers" : std::to_string(count) + " finite numbers";
  const std::string value = text(key);
  std::vector<double> numbers;
  for (std::size_t begin = value.find_first_not_of(kBlanks); begin != std::string::npos;) {
    const std::size_t end = value.find_first_of(kBlanks, begin);
    const auto number = finiteNumber(value.substr(begin, end - begin));
    if (!number) {
      throw error(tag() + " " + key, expected, "'" + value + "'",
                  remedyFor(value, "separate them by blanks"));
    }
    numbers.push_back(*number);
    begin = value.find_first_not_of(kBlanks, end);
  }
  if (numbers.size() != count) {
    throw error(tag() + " " + key, expected,
                std::to_string(numbers.size()) + " in '" + value + "'");
  }
  return numbers;
}

Eigen::Vector3d UrdfElement::vector(const char* key) const {
  return Eigen::Vector3d(numbers(key, 3).data());
}

void UrdfElement::checkSize(const std::string& what, double value, double greatest,
                            const std::string& unit) const {
  if (std::abs(value) <= greatest) return;
  const std::string got = numberText(value) + " " + unit;
  if (!(std::abs(value) <= kLargestNumber)) {
    throw error(what, "a number up to 1e50", got, "correct it, or its unit");
  }
  warn(what + ": " + got + " is beyond " + numberText(greatest) + " " + unit +
       "; is the unit right?");
}

// ---------------------------------------------------------------------------------------------
// Children

std::vector<const XMLElement*> childrenOf(const XMLElement& parent, const char* tag) {
  std::vector<const XMLElement*> children;
  for (auto* next = parent.FirstChildElement(tag); next != nullptr;
       next = next->NextSiblingElement(tag)) {
    children.push_back(next);
  }
  return children;
}

std::optional<UrdfElement> UrdfElement::child(const char* child_tag) const {
  const auto found = childrenOf(*element_, child_tag);
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw UrdfElement(*found[1], item_, *findings_)
        .error("<" + std::string(child_tag) + ">", "at most one", std::to_string(found.size()));
  }
  return UrdfElement(*found[0], item_, *findings_);
}

UrdfElement UrdfElement::requiredChild(const char* child_tag, const std::string& remedy) const {
  if (const auto found = child(child_tag)) return *found;
  std::vector<std::string> given;
  for (const XMLElement* element : childrenOf(*element_)) given.emplace_back(element->Name());
  const std::string similar = nearestName(child_tag, given);
  throw error(tag(), "<" + std::string(child_tag) + ">", "none",
              similar.empty() ? remedy : "is it misspelt as <" + similar + ">?");
}

// ---------------------------------------------------------------------------------------------
// Unknown names

void UrdfElement::reportUnknown(const Vocabulary& known) const {
  known_ = &known;
  reportAttributes(known);
  reportChildren(known);
}

void UrdfElement::reportAttributes(const Vocabulary& known) const {
  for (auto* next = element_->FirstAttribute(); next != nullptr; next = next->Next()) {
    reportName(where(), next->Name(), false, known.attributes, known.other_attributes);
  }
}

void UrdfElement::reportChildren(const Vocabulary& known) const {
  for (auto* next = element_->FirstChild(); next != nullptr; next = next->NextSibling()) {
    const std::string at = place(next->GetLineNum()) + ": " + item_;
    const tinyxml2::XMLText* const text = next->ToText();
    if (text != nullptr &&
        std::string(text->Value()).find_first_not_of(kBlanks) != std::string::npos) {
      findings_->addOnce("text", at + ": text in " + tag() + " isn't read");
    }
    if (next->ToElement() != nullptr) {
      reportName(at, next->ToElement()->Name(), true, known.children, known.other_children);
    }
  }
}

void UrdfElement::reportName(const std::string& at, const std::string& name, bool is_element,
                             const std::vector<std::string>& read,
                             const std::vector<std::string>& others) const {
  if (isXacro(name)) {
    findings_->addOnce(Findings::kXacro, at + ": " + quoted(name, is_element) +
                                             " isn't read; expand the file with xacro first");
    return;
  }
  if (contains(read, name) || contains(others, name) || isOfNamespace(name)) return;
  if (findings_->isFull()) {  // hostile: don't compare with each known name any more
    findings_->add(name);
    return;
  }
  std::vector<std::string> known = read;
  known.insert(known.end(), others.begin(), others.end());
  const std::string unread =
      at + ": " + (is_element ? "" : tag() + " ") + quoted(name, is_element) + " isn't read";
  const std::string similar = nearestName(name, known);
  if (!similar.empty()) {
    findings_->add(unread + "; did you mean " + quoted(similar, is_element) + "?");
  } else {
    std::vector<std::string> list;
    list.reserve(read.size());
    for (const std::string& one : read) list.push_back(quoted(one, is_element));
    const std::string in_tag = is_element ? " in " + tag() : "";
    findings_->addOnce(tag() + quoted(name, is_element),
                       unread + (list.empty() ? "" : "; read" + in_tag + ": " + joined(list)));
  }
}

}  // namespace v2
}  // namespace chain_dynamics
