// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where installed packages keep their files.
///
///     installedPackageShare("inverse_dynamics_robots");   // /opt/arm/share/inverse_dynamics_robots
#pragma once

#include <string>

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Directory `share/PACKAGE` of an installed package; empty if there is no such package.
///
/// Looks in the sourced workspaces, the last sourced first. A library that was built without ROS
/// looks first in the installation that it is part of. Threads: safe.
std::string installedPackageShare(const std::string& package);

/// Text of the error of a package that isn't installed: where it was looked for, and the remedy.
///
/// `package arm: not found: expected an installed package of that name, got none in /opt/arm; ...`
std::string packageNotFoundText(const std::string& package);

}  // namespace v2
}  // namespace inverse_dynamics_solver
