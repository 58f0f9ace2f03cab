// SPDX-License-Identifier: Apache-2.0
/// @file
/// Stand-ins with the signatures of rclcpp::Parameter and
/// rclcpp::node_interfaces::NodeParametersInterface, as far as parameters are read. An undeclared
/// parameter throws, one that is declared but not set throws on get_parameter(name).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stand_in {

enum class ParameterType : std::uint8_t {
  PARAMETER_NOT_SET = 0,
  PARAMETER_BOOL = 1,
  PARAMETER_INTEGER = 2,
  PARAMETER_DOUBLE = 3,
  PARAMETER_STRING = 4,
  PARAMETER_BYTE_ARRAY = 5,
  PARAMETER_BOOL_ARRAY = 6,
  PARAMETER_INTEGER_ARRAY = 7,
  PARAMETER_DOUBLE_ARRAY = 8,
  PARAMETER_STRING_ARRAY = 9
};

// In the order of ParameterType.
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                           std::vector<std::uint8_t>, std::vector<bool>, std::vector<std::int64_t>,
                           std::vector<double>, std::vector<std::string>>;

struct ParameterValue {
  Value value;
};

class Parameter {
 public:
  using Value = stand_in::Value;

  Parameter() = default;
  explicit Parameter(Value value) : value_(std::move(value)) {}
  Parameter(const std::string&, const ParameterValue& value) : value_(value.value) {}
  ParameterType get_type() const { return static_cast<ParameterType>(value_.index()); }
  bool as_bool() const { return std::get<bool>(value_); }
  std::int64_t as_int() const { return std::get<std::int64_t>(value_); }
  double as_double() const { return std::get<double>(value_); }
  const std::string& as_string() const { return std::get<std::string>(value_); }
  const std::vector<bool>& as_bool_array() const { return std::get<std::vector<bool>>(value_); }
  const std::vector<std::int64_t>& as_integer_array() const {
    return std::get<std::vector<std::int64_t>>(value_);
  }
  const std::vector<double>& as_double_array() const {
    return std::get<std::vector<double>>(value_);
  }
  const std::vector<std::string>& as_string_array() const {
    return std::get<std::vector<std::string>>(value_);
  }

 private:
  Value value_;
};

struct ListParametersResult {
  std::vector<std::string> names;
};

class NodeParametersInterface {
 public:
  using SharedPtr = std::shared_ptr<NodeParametersInterface>;
  using ConstSharedPtr = std::shared_ptr<const NodeParametersInterface>;
  virtual ~NodeParametersInterface() = default;
  virtual bool has_parameter(const std::string& name) const = 0;
  virtual Parameter get_parameter(const std::string& name) const = 0;
  virtual bool get_parameter(const std::string& name, Parameter& parameter) const = 0;
  virtual ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                               std::uint64_t depth) const = 0;
  virtual const std::map<std::string, ParameterValue>& get_parameter_overrides() const = 0;
};

class NodeParameters : public NodeParametersInterface {
 public:
  std::map<std::string, Parameter::Value> values;   // declared; the monostate: not set
  std::map<std::string, ParameterValue> overrides;  // set from outside, declared or not

  bool has_parameter(const std::string& name) const override { return values.count(name) > 0; }
  Parameter get_parameter(const std::string& name) const override {
    Parameter parameter;
    if (!get_parameter(name, parameter)) throw std::runtime_error("not declared or not set");
    return parameter;
  }
  bool get_parameter(const std::string& name, Parameter& parameter) const override {
    const auto found = values.find(name);
    if (found == values.end() || found->second.index() == 0) return false;
    parameter = Parameter(found->second);
    return true;
  }

  /// Of all depths and prefixes.
  ListParametersResult list_parameters(const std::vector<std::string>&,
                                       std::uint64_t) const override {
    ListParametersResult result;
    for (const auto& [name, value] : values) result.names.push_back(name);
    return result;
  }
  const std::map<std::string, ParameterValue>& get_parameter_overrides() const override {
    return overrides;
  }
};

}  // namespace stand_in
