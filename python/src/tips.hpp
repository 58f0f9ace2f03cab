// SPDX-License-Identifier: Apache-2.0
/// @file
/// Tips as Python gives them, and what a tree is to it.
#pragma once

#include <array>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/text.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstddef>
#include <inverse_dynamics_solver/configuration.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "parameters.hpp"

namespace inverse_dynamics_tools {

/// One text [chain_dynamics::tipsNamed()], or names.
using Tips = std::variant<std::string, std::vector<std::string>>;

inline std::string textOf(const Tips& tips) {
  const auto* const names = std::get_if<std::vector<std::string>>(&tips);
  return names != nullptr ? chain_dynamics::joined(*names) : std::get<std::string>(tips);
}

/// A mechanism from a description as Python gives it.
///
/// @param motors  `motors` and `motor_names`, as solvers take them; empty: joints are the coordinates.
inline chain_dynamics::Mechanism mechanismFrom(const std::string& urdf, const std::string& root,
                                               const Tips& tip,
                                               const std::optional<std::array<double, 3>>& gravity,
                                               const std::map<std::string, double>& locked_joints,
                                               const ParameterValues& motors) {
  chain_dynamics::UrdfOptions options;
  options.locked_position = [&](const std::string& joint) {
    const auto found = locked_joints.find(joint);
    return found == locked_joints.end() ? std::nullopt : std::optional<double>(found->second);
  };
  options.root = root;
  options.tip = textOf(tip);
  if (gravity) options.gravity = Eigen::Vector3d(gravity->data());
  if (motors.empty()) return chain_dynamics::mechanismFromUrdf(urdf, options);
  auto configuration = inverse_dynamics_solver::readConfiguration(motors, "", urdf);
  configuration.root = root;
  configuration.tip = options.tip;
  configuration.gravity_given = gravity.has_value();
  if (gravity) configuration.gravity = *options.gravity;
  configuration.locked_position = options.locked_position;
  return mechanismFromDescription(configuration);
}

/// Names of the joints that move the links, by the numbers of these.
inline std::vector<std::string> linkJoints(const chain_dynamics::Mechanism& mechanism) {
  if (mechanism.branches.empty()) return mechanism.coordinates.jointNames();
  std::vector<std::string> names(
      static_cast<std::size_t>(chain_dynamics::linkCount(mechanism.branches)));
  for (const chain_dynamics::Branch& branch : mechanism.branches) {
    for (std::size_t i = 0; i < branch.link.size(); ++i) {
      names[static_cast<std::size_t>(branch.link[i])] = branch.chain.joints()[i].name;
    }
  }
  return names;
}

}  // namespace inverse_dynamics_tools
