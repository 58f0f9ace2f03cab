// SPDX-License-Identifier: Apache-2.0
/// @file
/// Registers a solver as a plugin, in a library that is opened by name and never linked.
///
///     INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(my_solver::MySolver)
///
/// In a ROS workspace this includes `PLUGINLIB_EXPORT_CLASS`, so pluginlib knows the class. Programs that were
/// built without ROS, the Python package that pip installs among them, open the same library without pluginlib:
/// it has one function, inverse_dynamics_make_plugin(), that makes an object of any class registered in it.
#pragma once

#include <map>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <typeinfo>
#include <utility>

namespace inverse_dynamics_solver {
inline namespace v2 {

using MakePlugin = void* (*)();
using PluginClasses = std::map<std::pair<std::string, std::string>, MakePlugin>;

/// Plugins of this library, by base class and class. Hidden: else libraries would share one table.
[[gnu::visibility("hidden")]] inline PluginClasses& pluginClassesOfThisLibrary() {
  static PluginClasses classes;
  return classes;
}

/// Registers a class when its library is opened.
///
/// The base class is known by its mangled name, so a plugin of another version of it isn't found.
template <class Derived, class Base>
bool registerPluginClass(const char* name) {
  const MakePlugin make = [] { return static_cast<void*>(static_cast<Base*>(new Derived)); };
  return pluginClassesOfThisLibrary().emplace(std::pair(typeid(Base).name(), name), make).second;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

/// A new object as a pointer to its base class; null if the library has no such class.
// NOLINTNEXTLINE(readability-identifier-naming): a symbol that is found by name, as C's are
extern "C" [[gnu::weak, gnu::visibility("default")]] void* inverse_dynamics_make_plugin(
    const char* base, const char* name) {
  const auto& classes = inverse_dynamics_solver::pluginClassesOfThisLibrary();
  const auto found = classes.find({base, name});
  return found == classes.end() ? nullptr : found->second();
}

#define INVERSE_DYNAMICS_SOLVER_JOINED_NAME_(a, b) a##b
#define INVERSE_DYNAMICS_SOLVER_UNIQUE_NAME_(a, b) INVERSE_DYNAMICS_SOLVER_JOINED_NAME_(a, b)
#define INVERSE_DYNAMICS_SOLVER_REGISTER_(Derived, Base)                                       \
  namespace {                                                                                  \
  [[maybe_unused]] const bool INVERSE_DYNAMICS_SOLVER_UNIQUE_NAME_(registered_, __COUNTER__) = \
      inverse_dynamics_solver::registerPluginClass<Derived, Base>(#Derived);                   \
  }

/// At namespace scope, once per class; `Solver` is written as in the plugin description.
#define INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(Solver)                            \
  PLUGINLIB_EXPORT_CLASS(Solver, inverse_dynamics_solver::InverseDynamicsSolver) \
  INVERSE_DYNAMICS_SOLVER_REGISTER_(Solver, inverse_dynamics_solver::InverseDynamicsSolver)
