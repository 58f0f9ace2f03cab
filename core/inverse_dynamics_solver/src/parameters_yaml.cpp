// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "chain_dynamics/located_yaml.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/parameters.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::LocatedValue;
using Scalars = std::vector<LocatedValue::Scalar>;

void throwInvalid(const std::string& text) { throw InvalidParameterValueException(text); }

template <class T>
bool is(const LocatedValue::Scalar& scalar) {
  return std::holds_alternative<T>(scalar);
}

const char* kindOf(const LocatedValue::Scalar& scalar) {
  return is<bool>(scalar) ? "true or false" : is<std::string>(scalar) ? "a text" : "a number";
}

template <class T>
std::vector<T> allOf(const Scalars& scalars) {
  std::vector<T> values;
  for (const LocatedValue::Scalar& scalar : scalars) values.push_back(std::get<T>(scalar));
  return values;
}

/// Entries of one kind; integers among doubles are doubles.
ParameterValue listOf(const std::vector<LocatedValue>& entries) {
  Scalars scalars;
  std::vector<double> numbers;
  bool integers = true;
  for (const LocatedValue& entry : entries) {
    scalars.push_back(entry.scalar());
    const std::string kind = kindOf(scalars.front());
    if (kindOf(scalars.back()) != kind) entry.fail(kind + ", as the entries before it");
    if (kind == "a number") numbers.push_back(entry.number());
    integers = integers && is<std::int64_t>(scalars.back());
  }
  if (integers) return allOf<std::int64_t>(scalars);
  if (!numbers.empty()) return numbers;
  if (is<bool>(scalars.front())) return allOf<bool>(scalars);
  return allOf<std::string>(scalars);
}

/// Key between a node's name and its parameters in ROS 2 parameter files.
const std::string kRosParameters = "ros__parameters.";

std::map<std::string, ParameterValue> valuesOf(const LocatedValue& document) {
  std::map<std::string, ParameterValue> values;
  for (const auto& [key, value] : document.map().leaves()) {
    if (value.isNull()) continue;  // as a parameter that isn't set
    const std::size_t node_end = key.find(kRosParameters);
    const std::string name =
        node_end == std::string::npos ? key : key.substr(node_end + kRosParameters.size());
    if (!values.emplace(name, parameterOf(value)).second) {
      value.refuse("parameter '" + name + "' stands here for a second time");
    }
  }
  return values;
}

}  // namespace

ParameterValue parameterOf(const LocatedValue& value) {
  if (value.isList()) return listOf(value.entries());
  return std::visit([](const auto& scalar) { return ParameterValue(scalar); }, value.scalar());
}

Parameters Parameters::fromYaml(const std::string& text, const std::string& where) {
  if (text.empty()) return {};
  return valuesOf(LocatedValue::ofText(text, where, &throwInvalid));
}

Parameters Parameters::fromYamlFile(const std::string& path) {
  return valuesOf(LocatedValue::ofFile(path, &throwInvalid));
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
