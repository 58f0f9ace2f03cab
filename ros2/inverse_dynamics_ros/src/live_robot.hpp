// SPDX-License-Identifier: Apache-2.0

/// @file
/// The robot of the live node.
///
///     LiveRobot robot{solver, {"joint_1", "joint_2"}, "package/Class", "base_link", "tool0", false};

#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

inline constexpr int kReminder = 10'000;  ///< ms between two log lines that say the same

/// A solver, and the names of its joints and links.
struct LiveRobot {
  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver;
  std::vector<std::string> joints;       ///< in messages, in the order of the chain
  std::string plugin;                    ///< package/Class
  std::string root, tip;                 ///< links; empty: not known
  bool efforts_without_gravity = false;  ///< measured ones
};

}  // namespace inverse_dynamics_ros
