// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/parameters.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// Names in the order of ParameterValue's alternatives.
const char* const kTypeNames[] = {
    "bool",          "integer",          "double",          "string",
    "list of bools", "list of integers", "list of doubles", "list of strings"};

std::size_t listSize(const ParameterValue& value) {
  return std::visit(
      [](const auto& v) -> std::size_t {
        using V = std::decay_t<decltype(v)>;
        if constexpr (std::is_arithmetic_v<V> || std::is_same_v<V, std::string>) {
          return 1;
        } else {
          return v.size();
        }
      },
      value);
}

bool isList(const ParameterValue& value) {
  return value.index() >= ParameterValue(std::vector<bool>()).index();
}

/// The value as a T, where the conversion loses nothing.
template <class T>
std::optional<T> convert(const ParameterValue& value) {
  if (const T* exact = std::get_if<T>(&value)) return *exact;
  if constexpr (std::is_same_v<T, double>) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      return static_cast<double>(*integer);
    }
  }
  if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&value)) {
      return std::vector<double>(integers->begin(), integers->end());
    }
  }

  // An empty list carries no type.
  if constexpr (!std::is_arithmetic_v<T> && !std::is_same_v<T, std::string>) {
    if (isList(value) && listSize(value) == 0) return T();
  }
  return std::nullopt;
}

}  // namespace

std::string typeName(const ParameterValue& value) { return kTypeNames[value.index()]; }

Parameters::Parameters(std::map<std::string, ParameterValue> values) {
  const auto shared =
      std::make_shared<const std::map<std::string, ParameterValue>>(std::move(values));
  find_ = [shared](const std::string& name) -> std::optional<ParameterValue> {
    const auto found = shared->find(name);
    if (found == shared->end()) return std::nullopt;
    return found->second;
  };
  names_ = [shared] {
    std::vector<std::string> names;
    for (const auto& [name, value] : *shared) names.push_back(name);
    return names;
  };
}

Parameters::Parameters(std::initializer_list<std::pair<const std::string, ParameterValue>> values)
    : Parameters(std::map<std::string, ParameterValue>(values)) {}

Parameters Parameters::watched(std::function<void(const std::string& name)> asked) const {
  Parameters result = *this;
  result.find_ = [all = *this, asked = std::move(asked)](const std::string& name) {
    asked(name);
    return all.find(name);
  };
  return result;
}

Parameters Parameters::strict() const {
  Parameters result = *this;
  result.strict_ = true;
  return result;
}

std::vector<std::string> Parameters::names() const {
  std::vector<std::string> names = names_();
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::optional<ParameterValue> Parameters::find(const std::string& name) const {
  return find_ ? find_(name) : std::nullopt;
}

template <class T>
std::optional<T> Parameters::get(const std::string& name) const {
  const std::optional<ParameterValue> value = find(name);
  if (!value) return std::nullopt;
  std::optional<T> converted = convert<T>(*value);
  if (!converted) {
    throw InvalidParameterValueException("parameter '" + name + "'", "wrong type",
                                         typeName(ParameterValue(T())), typeName(*value),
                                         "correct it where it is set");
  }
  return converted;
}

template <class T>
T Parameters::require(const std::string& name) const {
  std::optional<T> value = get<T>(name);
  if (!value) {
    throw ParameterUninitializedException("parameter '" + name + "'", "not set",
                                          typeName(ParameterValue(T())), "nothing",
                                          "set it; it has no default");
  }
  return *std::move(value);
}

#define INVERSE_DYNAMICS_SOLVER_INSTANTIATE(T)                                 \
  template std::optional<T> Parameters::get<T>(const std::string& name) const; \
  template T Parameters::require<T>(const std::string& name) const;
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(bool)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::int64_t)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(double)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::string)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::vector<bool>)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::vector<std::int64_t>)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::vector<double>)
INVERSE_DYNAMICS_SOLVER_INSTANTIATE(std::vector<std::string>)
#undef INVERSE_DYNAMICS_SOLVER_INSTANTIATE

namespace detail {

void throwUnsupportedType(const std::string& name, int type) {
  const std::string got = type == static_cast<int>(ParameterType::kByteArray)
                              ? "list of bytes"
                              : "type number " + std::to_string(type);
  throw InvalidParameterValueException("parameter '" + name + "'", "wrong type",
                                       "bool, integer, double, string, or a list of these", got,
                                       "correct it where it is set");
}

}  // namespace detail
}  // namespace v2
}  // namespace inverse_dynamics_solver
