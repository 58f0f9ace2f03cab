// SPDX-License-Identifier: Apache-2.0
/// @file
/// Named parameters from wherever they are: a ROS 2 node, a map, a YAML text. No header of ROS is
/// needed.
///
///     solver->initialize(node->get_node_parameters_interface(), "ids");       // rclcpp
///     solver->initialize({{"root", "base_link"}, {"tip", "tool0"}});           // a map
///     solver->initialize(Parameters::fromYamlFile("robot.yaml"), "ids");       // YAML
#pragma once

#include <chain_dynamics/located_yaml.hpp>
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

namespace chain_dynamics {
inline namespace v2 {
class LocatedValue;
}  // namespace v2
}  // namespace chain_dynamics

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The types a parameter can have; those of ROS 2 but byte arrays.
using ParameterValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<bool>,
                 std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>>;

namespace detail {

/// True for what reads like rclcpp's NodeParametersInterface (or a whole rclcpp::Node).
template <class T, class = void>
struct IsParametersInterface : std::false_type {};
template <class T>
struct IsParametersInterface<
    T, std::void_t<decltype(std::declval<T&>().has_parameter(std::string())),
                   decltype(std::declval<T&>().get_parameter(std::string()).get_type()),
                   decltype(std::declval<T&>().list_parameters({}, std::uint64_t{0}).names)>>
    : std::true_type {};

/// Value of the parameter `name` of such an interface; absent if not set.
template <class Interface>
std::optional<ParameterValue> readParameter(Interface& interface, const std::string& name);

/// Names of all parameters that are set in such an interface.
template <class Interface>
std::vector<std::string> setParameters(Interface& interface);

}  // namespace detail

/// A reader of named parameters, type-erased, cheap to copy.
///
/// Names are dotted (`ids.gravity`). Values are read at the moment of asking, so a change in a node
/// is seen by the next initialize(). The reader keeps a shared_ptr source alive.
class Parameters {
 public:
  /// No parameter at all.
  Parameters() = default;
  Parameters(std::nullptr_t) {}  // NOLINT(google-explicit-constructor)

  /// The parameters of a ROS 2 node.
  ///
  /// @param interface  any shared_ptr, to const or not, to an object with has_parameter(),
  ///     get_parameter() and list_parameters() of rclcpp's NodeParametersInterface. Where it has
  ///     get_parameter_overrides() as well, a parameter that was set from outside (launch file,
  ///     command line) is found whether the node has declared it or not. A null pointer is no
  ///     parameter at all.
  template <class Interface,
            class = std::enable_if_t<detail::IsParametersInterface<Interface>::value>>
  Parameters(std::shared_ptr<Interface> interface) {  // NOLINT(google-explicit-constructor)
    if (interface == nullptr) return;
    find_ = [interface](const std::string& name) {
      return detail::readParameter(*interface, name);
    };
    shared_ = true;
    names_ = [interface] { return detail::setParameters(*interface); };
  }

  /// The parameters of a map from dotted name to value.
  Parameters(std::map<std::string, ParameterValue> values);  // NOLINT(google-explicit-constructor)
  Parameters(std::initializer_list<std::pair<const std::string, ParameterValue>> values);

  /// The parameters of a YAML text, read as in chain_dynamics/located_yaml.hpp. Nested maps become
  /// dotted names, null is absence; in a ROS 2 parameter file everything down to `ros__parameters`
  /// is left out of the names.
  ///
  /// @param text   the YAML; empty: no parameter.
  /// @param where  what to call it in errors, for example its file name.
  /// Throws InvalidParameterValueException with line: not YAML, not a map, a name twice, mixed or
  /// nested list.
  static Parameters fromYaml(const std::string& text, const std::string& where = "YAML");

  /// The same from a file. Throws also where it can't be read.
  static Parameters fromYamlFile(const std::string& path);

  /// The value, or nothing if the parameter is absent or not set.
  std::optional<ParameterValue> find(const std::string& name) const;

  /// The value as a T (one of the types of ParameterValue), or nothing if absent.
  ///
  /// An integer is accepted where a double is asked for, in arrays too; an empty list is an empty
  /// list of any type. Throws InvalidParameterValueException: another type.
  template <class T>
  std::optional<T> get(const std::string& name) const;

  /// The value as a T. Throws ParameterUninitializedException: absent; else as get().
  template <class T>
  T require(const std::string& name) const;

  /// The same parameters, reporting each requested name.
  Parameters watched(std::function<void(const std::string& name)> asked) const;

  /// The same parameters, of which a solver must know all: initialize() throws
  /// InvalidParameterValueException for an unknown name instead of adding a warning.
  Parameters strict() const;
  bool isStrict() const { return strict_; }

  /// Names of the parameters that are set, sorted.
  std::vector<std::string> names() const;

  /// Whether others keep their parameters in the same place: true for a node, which has some of its
  /// own; false for a map or YAML, which was made for the reader.
  bool isShared() const { return shared_; }

 private:
  std::function<std::optional<ParameterValue>(const std::string&)> find_;
  std::function<std::vector<std::string>()> names_ = [] { return std::vector<std::string>(); };
  bool shared_ = false;
  bool strict_ = false;
};

/// A plain value or a list of values of one type; integers among doubles are doubles. Throws what
/// the value throws.
ParameterValue parameterOf(const chain_dynamics::LocatedValue& value);

/// For error texts: `bool`, `integer`, `double`, `string`, `list of bools`, ...
std::string typeName(const ParameterValue& value);

namespace detail {

/// Numbers of rcl_interfaces/msg/ParameterType, the same in every ROS 2.
enum class ParameterType {
  kNotSet = 0,
  kBool = 1,
  kInteger = 2,
  kDouble = 3,
  kString = 4,
  kByteArray = 5,
  kBoolArray = 6,
  kIntegerArray = 7,
  kDoubleArray = 8,
  kStringArray = 9
};

[[noreturn]] void throwUnsupportedType(const std::string& name, int type);

/// The value of an object with the methods of rclcpp::Parameter; absent if its type is "not set".
template <class Parameter>
std::optional<ParameterValue> valueOf(const std::string& name, const Parameter& parameter) {
  const int type = static_cast<int>(parameter.get_type());
  switch (static_cast<ParameterType>(type)) {
    case ParameterType::kNotSet:
      return std::nullopt;
    case ParameterType::kBool:
      return ParameterValue(bool{parameter.as_bool()});
    case ParameterType::kInteger:
      return ParameterValue(std::int64_t{parameter.as_int()});
    case ParameterType::kDouble:
      return ParameterValue(double{parameter.as_double()});
    case ParameterType::kString:
      return ParameterValue(std::string(parameter.as_string()));
    case ParameterType::kBoolArray:
      return ParameterValue(std::vector<bool>(parameter.as_bool_array()));
    case ParameterType::kIntegerArray:
      return ParameterValue(std::vector<std::int64_t>(parameter.as_integer_array()));
    case ParameterType::kDoubleArray:
      return ParameterValue(std::vector<double>(parameter.as_double_array()));
    case ParameterType::kStringArray:
      return ParameterValue(std::vector<std::string>(parameter.as_string_array()));
    case ParameterType::kByteArray:
      break;
  }
  throwUnsupportedType(name, type);
}

/// True where `get_parameter_overrides()` exists, whose values make a parameter.
template <class T, class Parameter, class = void>
struct HasOverrides : std::false_type {};
template <class T, class Parameter>
struct HasOverrides<
    T, Parameter,
    std::void_t<decltype(Parameter(std::string(),
                                   std::declval<T&>().get_parameter_overrides().begin()->second))>>
    : std::true_type {};

/// The parameter `name`; absent if undeclared and not set from outside.
template <class Interface>
auto findParameter(Interface& interface, const std::string& name) {
  using Parameter = std::decay_t<decltype(interface.get_parameter(name))>;
  if (!interface.has_parameter(name)) {
    if constexpr (HasOverrides<Interface, Parameter>::value) {
      const auto& overrides = interface.get_parameter_overrides();
      const auto found = overrides.find(name);
      if (found != overrides.end()) return std::optional(Parameter(name, found->second));
    }
    return std::optional<Parameter>();
  }
  // This overload doesn't throw for a parameter that is declared with a type but not set.
  std::optional<Parameter> parameter(std::in_place);
  if (!interface.get_parameter(name, *parameter)) parameter.reset();
  return parameter;
}

template <class Interface>
std::optional<ParameterValue> readParameter(Interface& interface, const std::string& name) {
  const auto parameter = findParameter(interface, name);
  return parameter ? valueOf(name, *parameter) : std::nullopt;
}

template <class Interface>
std::vector<std::string> setParameters(Interface& interface) {
  using Parameter = std::decay_t<decltype(interface.get_parameter(std::string()))>;
  constexpr std::uint64_t kAllDepths = 0;
  std::vector<std::string> names = interface.list_parameters({}, kAllDepths).names;
  if constexpr (HasOverrides<Interface, Parameter>::value) {
    for (const auto& [name, value] : interface.get_parameter_overrides()) names.push_back(name);
  }

  // A node may have declared a parameter that nobody has set.
  std::vector<std::string> result;
  for (const std::string& name : names) {
    const auto parameter = findParameter(interface, name);
    const bool is_set =
        parameter && static_cast<ParameterType>(static_cast<int>(parameter->get_type())) !=
                         ParameterType::kNotSet;
    if (is_set) result.push_back(name);
  }
  return result;
}

}  // namespace detail
}  // namespace v2
}  // namespace inverse_dynamics_solver
