// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/solver_loader.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <vector>

#include "ament_index.hpp"
#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::joined;
using chain_dynamics::nearestName;
using PluginLoader = pluginlib::ClassLoader<InverseDynamicsSolver>;

const char* const kSource =
    "install its package, or source the workspace that has it: source install/local_setup.bash";

/// Installed plugin descriptions: package and prefix.
using PluginIndex = std::map<std::string, std::string>;

/// pluginlib's loader isn't thread-safe.
std::mutex& pluginlibMutex() {
  static std::mutex mutex;
  return mutex;
}

/// The process's one loader of the plugins in an index; call it with the mutex locked.
///
/// Never destroyed, and so its libraries stay open: an exception that a plugin has thrown needs the
/// plugin's code until it has been handled, and a solver may live until the end of the program.
PluginLoader& pluginLoader(const PluginIndex& index) {
  static auto& loaders = *new std::map<PluginIndex, std::unique_ptr<PluginLoader>>;
  std::unique_ptr<PluginLoader>& loader = loaders[index];
  if (loader == nullptr) {
    loader = std::make_unique<PluginLoader>("inverse_dynamics_solver",
                                            "inverse_dynamics_solver::InverseDynamicsSolver");
  }
  return *loader;
}

/// "did you mean NAME?" with the plugin that a misspelt name most likely means; else empty.
std::string suggestion(const std::string& name, const std::vector<std::string>& available) {
  // The class alone is a common shorthand of `package/Class`.
  std::vector<std::string> classes;
  classes.reserve(available.size());
  for (const std::string& plugin : available) {
    classes.push_back(plugin.substr(plugin.find('/') + 1));
  }
  std::string plugin = nearestName(name, available);
  if (plugin.empty()) {
    const std::string found = nearestName(name, classes);
    const auto place = std::find(classes.begin(), classes.end(), found) - classes.begin();
    if (!found.empty()) plugin = available[static_cast<std::size_t>(place)];
  }
  return plugin.empty() ? "" : "did you mean " + plugin + "?";
}

/// Whether the dynamic linker looked for a name of ours in vain: the number of the ABI namespace is
/// part of each.
bool missesOurSymbol(const std::string& error) {
  const auto symbol = error.find("undefined symbol: ");
  return symbol != std::string::npos &&
         (error.find("23inverse_dynamics_solver", symbol) != std::string::npos ||
          error.find("14chain_dynamics", symbol) != std::string::npos);
}

}  // namespace

struct SolverLoader::Implementation {
  PluginLoader* loader = nullptr;  // null: no workspace is sourced, or none has a plugin
  std::vector<std::string> names;
  std::string index_error;

  Implementation() {
    const std::lock_guard<std::mutex> lock(pluginlibMutex());
    try {
      // Asked first: with an empty index Debian's pluginlib would search for ROS 1 packages, slowly
      // and loudly.
      const PluginIndex index =
          ament_index::resources("inverse_dynamics_solver__pluginlib__plugin");
      if (index.empty()) return;
      loader = &pluginLoader(index);
      names = loader->getDeclaredClasses();
      std::sort(names.begin(), names.end());
    } catch (const std::exception& e) {
      index_error = e.what();
    }
  }

  void requireAvailable(const std::string& name) const {
    const std::string where = "solver plugin '" + name + "'";
    if (names.empty()) {
      throw PluginNotFoundException(
          where, "not found", "a plugin of an installed package",
          "no installed plugin at all" + (index_error.empty() ? "" : " (" + index_error + ")"),
          kSource);
    }
    if (std::binary_search(names.begin(), names.end(), name)) return;

    const std::string nearest = suggestion(name, names);
    throw PluginNotFoundException(where, "not found", "one of " + joined(names), "'" + name + "'",
                                  nearest.empty() ? kSource : nearest);
  }
};

SolverLoader::SolverLoader() : implementation_(std::make_unique<Implementation>()) {}
SolverLoader::~SolverLoader() = default;
SolverLoader::SolverLoader(SolverLoader&&) noexcept = default;
SolverLoader& SolverLoader::operator=(SolverLoader&&) noexcept = default;

std::vector<std::string> SolverLoader::availableSolvers() const { return implementation_->names; }

std::string SolverLoader::description(const std::string& name) const {
  implementation_->requireAvailable(name);
  const std::lock_guard<std::mutex> lock(pluginlibMutex());
  return implementation_->loader->getClassDescription(name);
}

std::shared_ptr<InverseDynamicsSolver> SolverLoader::load(const std::string& name) const {
  implementation_->requireAvailable(name);
  const std::lock_guard<std::mutex> lock(pluginlibMutex());
  PluginLoader& loader = *implementation_->loader;
  const std::string where = "solver plugin '" + name + "'";
  try {
    return loader.createUniqueInstance(name);
  } catch (const pluginlib::CreateClassException&) {
    throw PluginNotFoundException(
        where, "its library has no such solver",
        "class " + loader.getClassType(name) + " made with this version of the interface",
        "none, or one made with another version",
        "rebuild package " + loader.getClassPackage(name) + " against this workspace");
  } catch (const pluginlib::PluginlibException& e) {
    throw PluginNotFoundException(
        where,
        missesOurSymbol(e.what()) ? "its library was built against another version of the interface"
                                  : "its library can't be opened",
        "", e.what(),
        "rebuild package " + loader.getClassPackage(name) + " against this workspace");
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
