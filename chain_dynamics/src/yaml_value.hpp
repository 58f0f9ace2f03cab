// SPDX-License-Identifier: Apache-2.0

/// @file
/// Values of a YAML file, read strictly, that know where they stand.
///
///     YamlMap joint(value);
///     const double mass = joint.required("mass").number();   // arm.yaml:7: mass: expected ...
///     joint.rejectOtherKeys();
///
/// yaml-cpp takes repeated and unknown keys silently, and reads .nan as a number.

#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// One value: the node, its file, and what messages call it.
class YamlValue {
 public:
  YamlValue(const YAML::Node& node, std::string file, std::string what)
      : node_(node), file_(std::move(file)), what_(std::move(what)) {}

  /// Bytes of a text; a large model has 100,000.
  static constexpr std::size_t kLongestText = 16U << 20U;

  /// The one document of a text.
  static YamlValue ofText(const std::string& text, const std::string& file);

  /// The value must be of that kind; ModelError otherwise.
  std::string text() const;
  double number() const;
  int wholeNumber() const;
  std::vector<double> numbers(std::size_t count) const;
  std::vector<YamlValue> list(std::size_t count) const;
  std::vector<YamlValue> list() const;

  /// One of a few words, as its place among them.
  std::size_t choice(const std::vector<std::string>& words) const;

  /// An error at this value; what was found is described.
  ModelError error(const std::string& expected, const std::string& remedy = "") const;

  /// `file:line`.
  std::string where() const;
  const std::string& what() const { return what_; }
  const std::string& file() const { return file_; }
  const YAML::Node& node() const { return node_; }

  /// The same value under another name.
  YamlValue named(const std::string& what) const { return {node_, file_, what}; }

 private:
  std::string description() const;

  YAML::Node node_;
  std::string file_;
  std::string what_;
};

/// A map whose keys must all be asked for.
class YamlMap {
 public:
  /// @param name  whether messages put the map's own name before its keys' names.
  explicit YamlMap(const YamlValue& value, bool name = true);

  YamlValue required(const std::string& key);
  std::optional<YamlValue> optional(const std::string& key);

  /// Call it after the last key: a key that nobody asked for is an error.
  void rejectOtherKeys() const;

  const YamlValue& value() const { return value_; }

 private:
  YamlValue value_;
  std::string prefix_;
  std::set<std::string> asked_;
};

}  // namespace v2
}  // namespace chain_dynamics
