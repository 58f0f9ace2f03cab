// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where packages are installed, in a build without ROS.
#pragma once

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <list>
#include <sstream>
#include <string>

namespace ament_index_cpp {
inline namespace without_ros {

/// Its address is in the library that has included this.
[[gnu::visibility("hidden")]] inline const char kThisLibrary = 0;

/// The installation that this library is part of, then those of sourced workspaces, then those in
/// INVERSE_DYNAMICS_PREFIX_PATH, where Python names the wheels that have plugins.
inline std::list<std::string> get_search_paths() {
  std::list<std::string> paths;
  Dl_info library{};
  if (dladdr(&kThisLibrary, &library) != 0 && library.dli_fname != nullptr) {
    std::error_code error;
    const auto file = std::filesystem::canonical(library.dli_fname, error);
    if (!error) paths.push_back(file.parent_path().parent_path().string());
  }
  for (const char* const variable : {"AMENT_PREFIX_PATH", "INVERSE_DYNAMICS_PREFIX_PATH"}) {
    const char* const value = std::getenv(variable);
    std::istringstream stream(value == nullptr ? "" : value);
    for (std::string path; std::getline(stream, path, ':');) {
      if (!path.empty()) paths.push_back(path);
    }
  }
  return paths;
}

/// The file of a package's entry in the ament index below a prefix.
inline std::filesystem::path index_entry(const std::string& prefix, const std::string& resource,
                                         const std::string& package) {
  return std::filesystem::path(prefix) / "share/ament_index/resource_index" / resource / package;
}

}  // namespace without_ros
}  // namespace ament_index_cpp
