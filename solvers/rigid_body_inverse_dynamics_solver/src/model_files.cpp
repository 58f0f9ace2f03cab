// SPDX-License-Identifier: Apache-2.0
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/installed_package.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::joined;
using inverse_dynamics_solver::Exception;
using std::filesystem::path;

const char* const kDataPackage = "inverse_dynamics_robots";

path modelsFolder() {
  const std::string share = inverse_dynamics_solver::installedPackageShare(kDataPackage);
  if (!share.empty()) return path(share) / "models";
  throw Exception(inverse_dynamics_solver::packageNotFoundText(kDataPackage));
}

bool isPath(const path& name_or_path) {
  const path extension = name_or_path.extension();
  return extension == ".yaml" || extension == ".yml" || name_or_path.has_parent_path();
}

/// The file, which exists.
path modelFile(const std::string& name_or_path) {
  if (isPath(name_or_path)) {
    if (std::filesystem::is_regular_file(name_or_path)) return name_or_path;
    throw Exception("model file '" + name_or_path + "'", "not found", "a model file",
                    "nothing at that path",
                    "give its path, or the name of an installed model, without .yaml: " +
                        joined(installedModels()));
  }
  path file = modelsFolder() / (name_or_path + ".yaml");
  if (std::filesystem::is_regular_file(file)) return file;
  throw Exception("model '" + name_or_path + "'", "not found",
                  "one of " + joined(installedModels()), "'" + name_or_path + "'",
                  "for a file of your own, give its path, ending in .yaml");
}

}  // namespace

std::vector<std::string> installedModels() {
  const path folder = modelsFolder();
  if (!std::filesystem::is_directory(folder)) {
    throw Exception(std::string("package ") + kDataPackage, "incomplete", "a folder of models",
                    folder.string() + " isn't there", "install the package again");
  }
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

chain_dynamics::Model readModel(const std::string& name_or_path) {
  const path file = modelFile(name_or_path);
  try {
    return chain_dynamics::modelFromFile(file.string());
  } catch (const chain_dynamics::ModelError& e) {
    throw Exception(e.what());
  }
}

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver
