// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/solver_loader.hpp"

#include <algorithm>
#include <ament_index_cpp/get_resources.hpp>
#include <atomic>
#include <mutex>
#include <pluginlib/class_loader.hpp>
#include <utility>

#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::editDistance;
using chain_dynamics::joined;
using PluginLoader = pluginlib::ClassLoader<InverseDynamicsSolver>;

const char* const kSource = "source the workspace that has it: source install/local_setup.bash";

/// True from the moment when static objects are being destroyed.
std::atomic<bool> exiting{false};

/// Call it after class_loader was used: what tells of the exit is made after class_loader's static
/// objects, and hence destroyed before them.
void watchForExit() {
  struct Notice {
    ~Notice() { exiting = true; }
  };
  static const Notice kNotice;
}

/// Owner of an object of class_loader, or of one whose code is in a plugin library.
///
/// What lives until the end of the program (in a static variable) isn't destroyed: class_loader's
/// static objects are gone by then, and with them the plugin libraries.
template <class T>
std::shared_ptr<T> ownUnlessExiting(std::unique_ptr<T> object) {
  return {object.release(), [](T* owned) {
            if (!exiting) delete owned;
          }};
}

/// Loader of the plugins in the index; null if there are none.
std::shared_ptr<PluginLoader> makePluginLoader() {
  // Asked first: with an empty index Debian's pluginlib would search for ROS 1 packages, slowly and
  // loudly.
  if (ament_index_cpp::get_resources("inverse_dynamics_solver__pluginlib__plugin").empty()) {
    return nullptr;
  }
  return ownUnlessExiting(std::make_unique<PluginLoader>(
      "inverse_dynamics_solver", "inverse_dynamics_solver::InverseDynamicsSolver"));
}

/// A solver, and the loader that must stay as long as the solver's code is needed.
struct LoadedSolver {
  std::shared_ptr<PluginLoader> loader;
  pluginlib::UniquePtr<InverseDynamicsSolver> solver;  // destroyed before the loader
};

/// "; did you mean NAME?" with the name nearest to the given one; empty if none is near.
std::string suggestion(const std::string& name, const std::vector<std::string>& available) {
  std::string nearest;
  std::size_t least = name.size() / 2 + 1;
  for (const std::string& candidate : available) {
    // The class alone is a common shorthand of `package/Class`.
    const std::string short_name = candidate.substr(candidate.find('/') + 1);
    const std::size_t distance =
        std::min(editDistance(name, candidate), editDistance(name, short_name));
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : "did you mean " + nearest + "?";
}

}  // namespace

struct SolverLoader::Implementation {
  // Null if no workspace is sourced, or none has a plugin.
  std::shared_ptr<PluginLoader> loader;
  std::vector<std::string> names;
  std::string index_error;
  std::mutex mutex;  // pluginlib's loader isn't thread-safe

  Implementation() {
    try {
      loader = makePluginLoader();
      if (loader != nullptr) names = loader->getDeclaredClasses();
      std::sort(names.begin(), names.end());
    } catch (const std::exception& e) {
      index_error = e.what();
    }
  }

  void requireAvailable(const std::string& name) const {
    const std::string where = "solver plugin '" + name + "'";
    if (names.empty()) {
      throw PluginNotFoundException(errorText(
          where, "not found", "a plugin of an installed package",
          "no installed plugin at all" + (index_error.empty() ? "" : " (" + index_error + ")"),
          kSource));
    }
    if (std::binary_search(names.begin(), names.end(), name)) return;

    const std::string nearest = suggestion(name, names);
    throw PluginNotFoundException(errorText(where, "not found", "one of " + joined(names),
                                            "'" + name + "'", nearest.empty() ? kSource : nearest));
  }
};

SolverLoader::SolverLoader() : implementation_(std::make_unique<Implementation>()) {}
SolverLoader::~SolverLoader() = default;
SolverLoader::SolverLoader(SolverLoader&&) noexcept = default;
SolverLoader& SolverLoader::operator=(SolverLoader&&) noexcept = default;

std::vector<std::string> SolverLoader::availableSolvers() const { return implementation_->names; }

std::string SolverLoader::description(const std::string& name) const {
  implementation_->requireAvailable(name);
  const std::lock_guard<std::mutex> lock(implementation_->mutex);
  return implementation_->loader->getClassDescription(name);
}

std::shared_ptr<InverseDynamicsSolver> SolverLoader::load(const std::string& name) const {
  implementation_->requireAvailable(name);
  const std::lock_guard<std::mutex> lock(implementation_->mutex);
  const std::shared_ptr<PluginLoader>& loader = implementation_->loader;
  const std::string where = "solver plugin '" + name + "'";
  std::string why;
  try {
    std::unique_ptr<LoadedSolver> made(
        new LoadedSolver{loader, loader->createUniqueInstance(name)});
    watchForExit();
    const std::shared_ptr<LoadedSolver> loaded = ownUnlessExiting(std::move(made));
    return {loaded, loaded->solver.get()};
  } catch (const pluginlib::CreateClassException&) {
    why = errorText(
        where, "its library has no such solver",
        "class " + loader->getClassType(name) + " made with this version of the interface",
        "none, or one made with another version",
        "rebuild package " + loader->getClassPackage(name) + " against this workspace");
  } catch (const pluginlib::PluginlibException& e) {
    why = errorText(where, "its library can't be opened", "", e.what(),
                    "rebuild package " + loader->getClassPackage(name));
  }
  watchForExit();
  throw PluginNotFoundException(why);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
