// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which packages have something, in a build without ROS.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "ament_index_cpp/get_search_paths.hpp"

namespace ament_index_cpp {
inline namespace without_ros {

/// Package and prefix of each entry of a kind in the ament index; the first installation that has
/// a package takes precedence.
inline std::map<std::string, std::string> get_resources(const std::string& resource) {
  std::map<std::string, std::string> found;
  for (const std::string& prefix : get_search_paths()) {
    const std::filesystem::path folder = index_entry(prefix, resource, "");
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
      found.emplace(entry.path().filename().string(), prefix);
    }
  }
  return found;
}

}  // namespace without_ros
}  // namespace ament_index_cpp
