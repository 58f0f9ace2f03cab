// SPDX-License-Identifier: Apache-2.0

#include "yaml_value.hpp"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "number.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

const char* const kWholeFile = "file";

// yaml-cpp counts lines from zero; a node that doesn't exist has none.
std::string place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

/// Where documents start, and nothing of what they hold.
class DocumentStarts : public YAML::EventHandler {
 public:
  const std::vector<YAML::Mark>& marks() const { return marks_; }

  void OnDocumentStart(const YAML::Mark& mark) override { marks_.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}

 private:
  std::vector<YAML::Mark> marks_;
};

/// Of a text that begins with a comma, or with a quoted table heading, yaml-cpp makes empty
/// documents without end, and never advances; of several documents it loads the first.
void checkOneDocument(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  while (parser.HandleNextDocument(starts)) {
    const std::vector<YAML::Mark>& marks = starts.marks();
    if (marks.size() > 1 && marks.back().pos == marks[marks.size() - 2].pos) {
      throw ModelError(place(file, marks.back()), kWholeFile, "one YAML document",
                       "a text that isn't YAML from here on", "is it a table?");
    }
  }
  if (starts.marks().size() > 1) {
    throw ModelError(file, kWholeFile, "one YAML document", std::to_string(starts.marks().size()),
                     "");
  }
}

}  // namespace

YamlValue YamlValue::ofText(const std::string& text, const std::string& file) {
  if (text.size() > kLongestText) {
    throw ModelError(file, kWholeFile, "at most 16 MiB", "more", "is it a model file?");
  }
  try {
    checkOneDocument(text, file);
    const YAML::Node document = YAML::Load(text);
    if (document.IsNull()) {
      throw ModelError(file, kWholeFile, "one YAML document", "an empty file", "");
    }
    return {document, file, kWholeFile};
  } catch (const YAML::Exception& error) {
    const bool deep = error.msg == YAML::ErrorMsg::BAD_FILE;
    throw ModelError(place(file, error.mark), kWholeFile, "well-formed YAML",
                     deep ? "too many lists or maps inside of each other" : error.msg,
                     "look at the lines above, too");
  }
}

std::string YamlValue::where() const { return place(file_, node_.Mark()); }

ModelError YamlValue::error(const std::string& expected, const std::string& remedy) const {
  return {where(), what_, expected, description(), remedy};
}

std::string YamlValue::description() const {
  switch (node_.Type()) {
    case YAML::NodeType::Scalar:
      // a text that isn't a model may be anyone's secret
      return what_ == kWholeFile ? "a text" : "'" + node_.Scalar() + "'";
    case YAML::NodeType::Sequence:
      return "a list of " + std::to_string(node_.size());
    case YAML::NodeType::Map:
      return "a map";
    default:
      return "nothing";
  }
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) {
    throw error("a text");
  }
  return node_.Scalar();
}

double YamlValue::number() const {
  // "?": written without quotation marks and without a tag
  const std::string& tag = node_.Tag();
  const bool plain = tag.empty() || tag == "?" || tag == "tag:yaml.org,2002:float" ||
                     tag == "tag:yaml.org,2002:int";
  const auto value =
      node_.IsScalar() && plain ? finiteNumber(node_.Scalar()) : std::optional<double>();
  if (!value) {
    throw error("a finite number");
  }
  return *value;
}

int YamlValue::wholeNumber() const {
  constexpr double kGreatest = 1000;
  const double value = number();
  if (value != std::round(value) || std::abs(value) > kGreatest) {
    throw error("a small whole number");
  }
  return static_cast<int>(value);
}

std::vector<YamlValue> YamlValue::list() const {
  if (!node_.IsSequence()) {
    throw error("a list");
  }
  std::vector<YamlValue> values;
  for (const YAML::Node& node : node_) {
    values.emplace_back(node, file_, what_ + "[" + std::to_string(values.size()) + "]");
  }
  return values;
}

std::vector<YamlValue> YamlValue::list(std::size_t count) const {
  if (!node_.IsSequence() || node_.size() != count) {
    throw error("a list of " + std::to_string(count));
  }
  return list();
}

std::vector<double> YamlValue::numbers(std::size_t count) const {
  if (!node_.IsSequence() || node_.size() != count) {
    throw error(std::to_string(count) + " numbers");
  }
  std::vector<double> values;
  for (const YamlValue& value : list()) {
    values.push_back(value.number());
  }
  return values;
}

std::size_t YamlValue::choice(const std::vector<std::string>& words) const {
  const std::string word = node_.IsScalar() ? node_.Scalar() : std::string();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    const std::string nearest = nearestName(word, words);
    throw error("one of " + joined(words), nearest.empty() ? "" : "did you mean " + nearest + "?");
  }
  return static_cast<std::size_t>(found - words.begin());
}

YamlMap::YamlMap(const YamlValue& value, bool name)
    : value_(value), prefix_(name ? value.what() + ": " : "") {
  if (!value.node().IsMap()) {
    throw value.error("a map of keys and values");
  }
  std::map<std::string, YAML::Mark> keys;
  for (const auto& entry : value.node()) {
    const YamlValue key(entry.first, value.file(), prefix_ + "key");
    const auto [first, inserted] = keys.emplace(key.text(), entry.first.Mark());
    if (!inserted) {
      throw ModelError(key.where(), prefix_ + key.text(), "each key once",
                       "it a second time, after line " + std::to_string(first->second.line + 1),
                       "remove one of them");
    }
  }
}

std::optional<YamlValue> YamlMap::optional(const std::string& key) {
  asked_.insert(key);
  const YAML::Node node = value_.node()[key];
  if (!node.IsDefined()) {
    return std::nullopt;
  }
  return YamlValue(node, value_.file(), prefix_ + key);
}

YamlValue YamlMap::required(const std::string& key) {
  const auto found = optional(key);
  if (!found) {
    throw ModelError(value_.where(), prefix_ + key, "this key", "none", "add it");
  }
  return *found;
}

void YamlMap::rejectOtherKeys() const {
  for (const auto& entry : value_.node()) {
    if (asked_.count(entry.first.Scalar()) == 0) {
      const YamlValue key(entry.first, value_.file(), prefix_ + entry.first.Scalar());
      throw ModelError(key.where(), key.what(), "a known key", "an unknown one",
                       "known here: " + joined({asked_.begin(), asked_.end()}));
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics
