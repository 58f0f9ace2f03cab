// SPDX-License-Identifier: Apache-2.0
/// @file
/// Stand-in with the signature that ament_index_cpp has from 1.13.2 on.
#pragma once

#include <filesystem>
#include <string>

namespace ament_index_cpp {
inline std::filesystem::path get_package_share_path(const std::string& package) {
  return std::filesystem::path("/prefix/share") / package;
}
}  // namespace ament_index_cpp
