// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <fstream>
#include <locale>
#include <sstream>

#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/parameters.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using Values = std::map<std::string, ParameterValue>;

/// Below this key, and only there, ROS 2 parameter files hold parameters.
const char* const kRosParameters = "ros__parameters";

/// `file.yaml:12`, lines counted from one.
std::string place(const std::string& where, const YAML::Mark& mark) {
  return mark.is_null() ? where : where + ":" + std::to_string(mark.line + 1);
}

[[noreturn]] void refuse(const std::string& where, const YAML::Node& node, const std::string& what,
                         const std::string& expected, const std::string& got,
                         const std::string& remedy) {
  throw InvalidParameterValueException(
      errorText(place(where, node.Mark()), what, expected, got, remedy));
}

std::optional<double> parseDouble(const std::string& text) {
  if (text == ".inf" || text == "+.inf") return std::numeric_limits<double>::infinity();
  if (text == "-.inf") return -std::numeric_limits<double>::infinity();
  if (text == ".nan") return std::numeric_limits<double>::quiet_NaN();
  if (text.find_first_of("0123456789") == std::string::npos) return std::nullopt;

  // The decimal separator is a point, whatever the user's locale.
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  stream >> value;
  if (stream.fail() || stream.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parseInteger(const std::string& text) {
  const std::size_t start = text.size() > 1 && text[0] == '+' ? 1 : 0;
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data() + start, end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

/// A quoted scalar is a string; else bool, integer, double, string: what fits first.
ParameterValue scalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str") return text;
  if (text == "true" || text == "True" || text == "TRUE") return true;
  if (text == "false" || text == "False" || text == "FALSE") return false;
  if (const auto integer = parseInteger(text)) return *integer;
  if (const auto real = parseDouble(text)) return *real;
  return text;
}

/// Entries of one type; integers among doubles are doubles.
ParameterValue list(const YAML::Node& node, const std::string& where, const std::string& name) {
  std::vector<ParameterValue> entries;
  for (const YAML::Node& entry : node) {
    if (!entry.IsScalar()) {
      refuse(where, entry, "parameter '" + name + "'", "a list of plain values",
             "a list, a map or null inside of it", "write nested values under names of their own");
    }
    entries.push_back(scalar(entry));
  }

  // One list of each type; the one that takes all entries is the result.
  std::vector<bool> bools;
  std::vector<std::int64_t> integers;
  std::vector<double> doubles;
  std::vector<std::string> strings;
  for (const ParameterValue& entry : entries) {
    if (const auto* v = std::get_if<bool>(&entry)) bools.push_back(*v);
    if (const auto* v = std::get_if<double>(&entry)) doubles.push_back(*v);
    if (const auto* v = std::get_if<std::string>(&entry)) strings.push_back(*v);
    if (const auto* v = std::get_if<std::int64_t>(&entry)) {
      integers.push_back(*v);
      doubles.push_back(static_cast<double>(*v));
    }
  }
  if (integers.size() == entries.size()) return integers;
  if (doubles.size() == entries.size()) return doubles;
  if (bools.size() == entries.size()) return bools;
  if (strings.size() == entries.size()) return strings;
  refuse(where, node, "parameter '" + name + "'", "a list of one type", "a mixed list",
         "write all entries as numbers, as true or false, or as strings in quotes");
}

/// Adds the parameters of a map, its keys prefixed, to `values`.
void flatten(const YAML::Node& map, const std::string& prefix, const std::string& where,
             Values& values) {
  for (const auto& entry : map) {
    const std::string key = entry.first.Scalar();
    const YAML::Node& node = entry.second;
    const std::string name = prefix.empty() ? key : prefix + "." + key;

    // What a ROS 2 parameter file holds above its parameters is the name of a node.
    if (node.IsMap()) {
      flatten(node, key == kRosParameters ? "" : name, where, values);
      continue;
    }
    if (node.IsNull()) continue;
    const ParameterValue value = node.IsScalar() ? scalar(node) : list(node, where, name);
    if (!values.emplace(name, value).second) {
      refuse(where, entry.first, "parameter '" + name + "'", "one value", "a second one",
             "remove one of them");
    }
  }
}

}  // namespace

Parameters Parameters::fromYaml(const std::string& text, const std::string& where) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw InvalidParameterValueException(
        errorText(place(where, e.mark), "not YAML", "", "", e.msg));
  }
  Values values;
  if (root.IsNull()) return values;
  if (!root.IsMap()) {
    refuse(where, root, "not parameters", "a map (name: value)",
           root.IsSequence() ? "a list" : "a single value", "give each value a name");
  }
  flatten(root, "", where, values);
  return values;
}

Parameters Parameters::fromYamlFile(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file) {
    throw Exception(errorText(path, "can't be read", "a YAML file of parameters", "",
                              "check that it exists, is a file and may be read"));
  }
  return fromYaml(text.str(), path);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
