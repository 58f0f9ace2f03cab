// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/installed_package.hpp"

#include <string>

#include "ament_index.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

std::string installedPackageShare(const std::string& package) {
  return ament_index::packageShare(package);
}

std::string packageNotFoundText(const std::string& package) {
  const std::string known = chain_dynamics::joined(ament_index::prefixes());
  return errorText(
      "package " + package, "not found", "an installed package of that name",
      known.empty() ? "no installed package, as no workspace is sourced" : "none in " + known,
      "install it, or source the workspace that has it: "
      "source install/local_setup.bash");
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
