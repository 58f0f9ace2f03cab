// SPDX-License-Identifier: Apache-2.0

/// @file
/// Where installed packages keep their files, by the ament index, as ROS 2 tools find them.
///
///     resolvedPath("package://my_package/urdf/arm.urdf", "");   // /opt/arm/share/my_package/urdf/...

#pragma once

#include <string>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A package that isn't installed.
class PackageNotFoundError : public ConfigurationError {
 public:
  using ConfigurationError::ConfigurationError;
};

/// Directory `share/PACKAGE` of an installed package.
///
/// Looked for as inverse_dynamics_solver::installedPackageShare does. @throws PackageNotFoundError.
std::string packageShare(const std::string& package);

/// File that a path in a configuration names.
///
/// @param path       `package://PACKAGE/FILE`: below the share directory of an installed package;
///     absolute, `~/FILE` too; else relative.
/// @param directory  that relative paths begin in: the configuration's.
/// @throws PackageNotFoundError
std::string resolvedPath(const std::string& path, const std::string& directory);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
