// SPDX-License-Identifier: Apache-2.0
/// @file
/// Stand-in with the signature that is left in ament_index_cpp from 1.14.1 on.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace ament_index_cpp {
inline std::map<std::string, std::filesystem::path> get_resources_by_name(const std::string& type) {
  return {{type, "/prefix"}};
}
}  // namespace ament_index_cpp
