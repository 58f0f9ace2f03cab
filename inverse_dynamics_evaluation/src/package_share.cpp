// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/package_share.hpp"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <inverse_dynamics_solver/installed_package.hpp>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPackage = "package://";

/// Home of a user; empty: of the one who runs the program.
std::string homeOf(const std::string& user) {
  const char* const home = std::getenv("HOME");
  if (user.empty() && home != nullptr && *home != '\0') {
    return home;
  }
  std::array<char, 16384> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  if (user.empty()) {
    getpwuid_r(getuid(), &entry, buffer.data(), buffer.size(), &found);
  } else {
    getpwnam_r(user.c_str(), &entry, buffer.data(), buffer.size(), &found);
  }
  if (found == nullptr) {
    throw ConfigurationError("there is no user " + user + ", so no home directory");
  }
  return entry.pw_dir;
}

}  // namespace

std::string packageShare(const std::string& package) {
  std::string share = inverse_dynamics_solver::installedPackageShare(package);
  if (share.empty()) {
    throw PackageNotFoundError(inverse_dynamics_solver::packageNotFoundText(package));
  }
  return share;
}

std::string resolvedPath(const std::string& path, const std::string& directory) {
  const std::string scheme = kPackage;
  if (path.rfind(scheme, 0) == 0) {
    const std::string rest = path.substr(scheme.size());
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string file = slash < rest.size() ? rest.substr(slash + 1) : "";
    return fs::path(packageShare(rest.substr(0, slash))) / file;
  }
  if (path.rfind('~', 0) == 0) {
    const std::size_t slash = std::min(path.find('/'), path.size());
    return homeOf(path.substr(1, slash - 1)) + path.substr(slash);
  }
  return fs::path(directory) / path;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
