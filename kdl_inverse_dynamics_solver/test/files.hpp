// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files the tests read.
#pragma once

#include <ament_index_cpp/get_package_share_directory.hpp>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace kdl_inverse_dynamics_solver::test {

inline std::string textOf(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!(text << file.rdbuf())) throw std::runtime_error("can't read " + path);
  return text.str();
}

/// Path of a file of the package of robots.
inline std::string robotsFile(const std::string& name) {
  return ament_index_cpp::get_package_share_directory("inverse_dynamics_robots") + "/" + name;
}

/// A chain with a revolute, a continuous and a prismatic joint, oblique axes, fixed joints, a link
/// before the first joint, and a gripper beside the tip.
inline std::string obliqueArm() { return textOf(TEST_DIRECTORY "/oblique_arm.urdf"); }

}  // namespace kdl_inverse_dynamics_solver::test
