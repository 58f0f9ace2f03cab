// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where a package keeps its files, in a build without ROS.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "ament_index_cpp/get_search_paths.hpp"

namespace ament_index_cpp {
inline namespace without_ros {

/// Directory `share/PACKAGE` of an installed package.
/// Throws std::out_of_range: no installation has it; the text lists where it was looked for.
inline std::string get_package_share_directory(const std::string& package) {
  std::string looked_in;
  for (const std::string& prefix : get_search_paths()) {
    if (std::filesystem::is_regular_file(index_entry(prefix, "packages", package))) {
      return prefix + "/share/" + package;
    }
    looked_in += (looked_in.empty() ? "" : ", ") + prefix;
  }
  throw std::out_of_range("package '" + package + "' not found, searching: [" + looked_in + "]");
}

}  // namespace without_ros
}  // namespace ament_index_cpp
