// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/package_share.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace fs = std::filesystem;

std::string packageShare(const std::string& package) {
  std::string share = inverse_dynamics_solver::installedPackageShare(package);
  if (share.empty()) {
    throw PackageNotFoundError(inverse_dynamics_solver::packageNotFoundText(package));
  }
  return share;
}

std::string resolvedPath(const std::string& path, const std::string& directory) {
  const std::string scheme = "package://";
  if (path.rfind(scheme, 0) == 0) {
    const std::string rest = path.substr(scheme.size());
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string file = slash < rest.size() ? rest.substr(slash + 1) : "";
    return fs::path(packageShare(rest.substr(0, slash))) / file;
  }
  const char* const home = std::getenv("HOME");
  if (path.rfind("~/", 0) == 0 && home != nullptr) return home + path.substr(1);
  return fs::path(directory) / path;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
