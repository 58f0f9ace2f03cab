// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/installed_package.hpp"

#include <exception>

#include "ament_index.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

std::string installedPackageShare(const std::string& package) {
  try {
    return ament_index::packageShare(package);
  } catch (const std::exception&) {  // not found, or no workspace is sourced
    return "";
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
