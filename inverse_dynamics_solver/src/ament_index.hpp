// SPDX-License-Identifier: Apache-2.0
/// @file
/// The ament index by one set of names: ament_index_cpp gives paths from 1.13.2 on (lyrical), and
/// strings until 1.14.0 (before rolling of 2026-06).
#pragma once

#include <ament_index_cpp/get_resources.hpp>
#include <map>
#include <string>

#if __has_include(<ament_index_cpp/get_package_share_path.hpp>)
#include <ament_index_cpp/get_package_share_path.hpp>
#define INVERSE_DYNAMICS_SOLVER_AMENT_INDEX_HAS_PATHS
#else
#include <ament_index_cpp/get_package_share_directory.hpp>
#endif

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace ament_index {

/// Throws what ament_index_cpp does where there is no such package.
inline std::string packageShare(const std::string& package) {
#ifdef INVERSE_DYNAMICS_SOLVER_AMENT_INDEX_HAS_PATHS
  return ament_index_cpp::get_package_share_path(package).string();
#else
  return ament_index_cpp::get_package_share_directory(package);
#endif
}

/// Names of the resources of a type, each with its installation prefix.
inline std::map<std::string, std::string> resources(const std::string& type) {
#ifdef INVERSE_DYNAMICS_SOLVER_AMENT_INDEX_HAS_PATHS
  std::map<std::string, std::string> found;
  for (const auto& [name, prefix] : ament_index_cpp::get_resources_by_name(type)) {
    found.emplace(name, prefix.string());
  }
  return found;
#else
  return ament_index_cpp::get_resources(type);
#endif
}

}  // namespace ament_index
}  // namespace v2
}  // namespace inverse_dynamics_solver
