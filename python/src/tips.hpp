// SPDX-License-Identifier: Apache-2.0
/// @file
/// Tips as Python gives them, and what a tree is to it.
#pragma once

#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace inverse_dynamics_tools {

/// One text [chain_dynamics::tipsNamed()], or names.
using Tips = std::variant<std::string, std::vector<std::string>>;

inline std::string textOf(const Tips& tips) {
  const auto* const names = std::get_if<std::vector<std::string>>(&tips);
  return names != nullptr ? chain_dynamics::joined(*names) : std::get<std::string>(tips);
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
