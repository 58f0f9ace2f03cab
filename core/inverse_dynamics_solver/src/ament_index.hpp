// SPDX-License-Identifier: Apache-2.0
/// @file
/// Resources of installed packages: the ament index, the same in every ROS 2 and in builds without it.
///
/// A package PACKAGE below PREFIX that has something of a kind has the file
/// `PREFIX/share/ament_index/resource_index/KIND/PACKAGE` [ament_cmake, doc/resource_index.md].
#pragma once

#ifdef INVERSE_DYNAMICS_WITHOUT_ROS
#include <dlfcn.h>
#endif

#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace ament_index {

/// Its address is in the library that has included this.
[[gnu::visibility("hidden")]] inline const char kThisLibrary = 0;

/// The installations, which take precedence in this order: sourced workspaces; without ROS before them
/// the one that this library is part of, and after them those in INVERSE_DYNAMICS_PREFIX_PATH, where
/// Python names the wheels that have plugins.
inline std::vector<std::string> prefixes() {
  std::vector<std::string> found;
  const auto add_listed = [&found](const char* variable) {
    const char* const value = std::getenv(variable);
    std::istringstream stream(value == nullptr ? "" : value);
    for (std::string prefix; std::getline(stream, prefix, ':');) {
      if (!prefix.empty()) found.push_back(prefix);
    }
  };
#ifdef INVERSE_DYNAMICS_WITHOUT_ROS
  Dl_info library{};
  if (dladdr(&kThisLibrary, &library) != 0 && library.dli_fname != nullptr) {
    std::error_code error;
    const auto file = std::filesystem::canonical(library.dli_fname, error);
    if (!error) found.push_back(file.parent_path().parent_path().string());
  }
#endif
  add_listed("AMENT_PREFIX_PATH");
#ifdef INVERSE_DYNAMICS_WITHOUT_ROS
  add_listed("INVERSE_DYNAMICS_PREFIX_PATH");
#endif
  return found;
}

inline std::filesystem::path entry(const std::string& prefix, const std::string& kind,
                                   const std::string& package = "") {
  return std::filesystem::path(prefix) / "share/ament_index/resource_index" / kind / package;
}

/// Package and prefix of each entry of a kind.
inline std::map<std::string, std::string> resources(const std::string& kind) {
  std::map<std::string, std::string> found;
  for (const std::string& prefix : prefixes()) {
    std::error_code missing;
    for (const auto& file : std::filesystem::directory_iterator(entry(prefix, kind), missing)) {
      found.emplace(file.path().filename().string(), prefix);
    }
  }
  return found;
}

/// Directory `share/PACKAGE` of an installed package; empty if there is none.
inline std::string packageShare(const std::string& package) {
  for (const std::string& prefix : prefixes()) {
    if (std::filesystem::is_regular_file(entry(prefix, "packages", package))) {
      return prefix + "/share/" + package;
    }
  }
  return "";
}

}  // namespace ament_index
}  // namespace v2
}  // namespace inverse_dynamics_solver
