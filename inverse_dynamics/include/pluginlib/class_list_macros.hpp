// SPDX-License-Identifier: Apache-2.0
/// @file
/// Registers plugins in a library that was built without ROS.
///
///     PLUGINLIB_EXPORT_CLASS(my_package::MySolver, inverse_dynamics_solver::InverseDynamicsSolver)
///
/// A library has one function, inverse_dynamics_make_plugin(), that makes an object of any class
/// that is registered in it.
#pragma once

#include <map>
#include <string>
#include <typeinfo>
#include <utility>

namespace pluginlib {
inline namespace without_ros {

using Make = void* (*)();
using Classes = std::map<std::pair<std::string, std::string>, Make>;

/// What this library has, by base class and class. Hidden: else libraries would share one table.
[[gnu::visibility("hidden")]] inline Classes& classes_of_this_library() {
  static Classes classes;
  return classes;
}

/// Registers a class when its library is opened.
///
/// The base class is known by its mangled name, so a plugin of another version of it isn't found.
template <class Derived, class Base>
bool register_class(const char* name) {
  const Make make = [] { return static_cast<void*>(static_cast<Base*>(new Derived)); };
  return classes_of_this_library().emplace(std::pair(typeid(Base).name(), name), make).second;
}

}  // namespace without_ros
}  // namespace pluginlib

/// A new object as a pointer to its base class; null if the library has no such class.
extern "C" [[gnu::weak, gnu::visibility("default")]] void* inverse_dynamics_make_plugin(
    const char* base, const char* name) {
  const auto& classes = pluginlib::classes_of_this_library();
  const auto found = classes.find({base, name});
  return found == classes.end() ? nullptr : found->second();
}

#define PLUGINLIB_JOINED_NAME(a, b) a##b
#define PLUGINLIB_UNIQUE_NAME(a, b) PLUGINLIB_JOINED_NAME(a, b)
#define PLUGINLIB_EXPORT_CLASS(Derived, Base)                                   \
  namespace {                                                                   \
  [[maybe_unused]] const bool PLUGINLIB_UNIQUE_NAME(registered_, __COUNTER__) = \
      pluginlib::register_class<Derived, Base>(#Derived);                       \
  }
