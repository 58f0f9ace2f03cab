// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/installed_package.hpp"

#include <cstdlib>
#include <exception>
#include <set>
#include <sstream>

#include "ament_index.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// The installations where packages are looked for, as `/a, /b`; empty if there are none.
std::string installations() {
  std::set<std::string> prefixes;
  const char* const sourced = std::getenv("AMENT_PREFIX_PATH");
  std::istringstream listed(sourced == nullptr ? "" : sourced);
  for (std::string prefix; std::getline(listed, prefix, ':');) {
    if (!prefix.empty()) prefixes.insert(prefix);
  }
  try {
    for (const auto& [package, prefix] : ament_index::resources("packages")) {
      prefixes.insert(prefix);
    }
  } catch (const std::exception&) {  // no workspace is sourced
  }
  std::string list;
  for (const std::string& prefix : prefixes) list += (list.empty() ? "" : ", ") + prefix;
  return list;
}

}  // namespace

std::string installedPackageShare(const std::string& package) {
  try {
    return ament_index::packageShare(package);
  } catch (const std::exception&) {  // not found, or no workspace is sourced
    return "";
  }
}

std::string packageNotFoundText(const std::string& package) {
  const std::string known = installations();
  return errorText(
      "package " + package, "not found", "an installed package of that name",
      known.empty() ? "no installed package, as no workspace is sourced" : "none in " + known,
      "install it, or source the workspace that has it: "
      "source install/local_setup.bash");
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
