// SPDX-License-Identifier: Apache-2.0
/// @file
/// Finds plugins and makes objects of them, in a build without ROS.
#pragma once

#include <dlfcn.h>
#include <tinyxml2.h>

#include <ament_index.hpp>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <vector>

namespace pluginlib {
inline namespace without_ros {

/// A description of plugins can't be read, or a library can't be opened.
class PluginlibException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A library doesn't have the class that the description names.
class CreateClassException : public PluginlibException {
 public:
  using PluginlibException::PluginlibException;
};

/// What a description says of a plugin.
struct PluginDescription {
  std::string type, package, description, library;
};

/// The plugins of installed packages that have a base class, by name.
using PluginDescriptions = std::map<std::string, PluginDescription>;

inline std::string attribute(const tinyxml2::XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

/// Adds what a file describes: a `library`, or several in a `class_libraries`. A file that can't be
/// read is reported and left out, as by pluginlib: the other packages' plugins are there.
inline void read_descriptions(const std::string& file, const std::string& prefix,
                              const std::string& package, const std::string& base,
                              PluginDescriptions& found) {
  tinyxml2::XMLDocument document;
  document.LoadFile(file.c_str());
  const tinyxml2::XMLElement* library = document.RootElement();
  if (document.Error() || library == nullptr) {
    std::cerr << file << ": expected descriptions of plugins: "
              << (document.Error() ? document.ErrorStr() : "there is no element") << "\n";
    return;
  }
  if (library->Name() == std::string("class_libraries")) {
    library = library->FirstChildElement("library");
  }
  for (; library != nullptr; library = library->NextSiblingElement("library")) {
    const auto* plugin = library->FirstChildElement("class");
    for (; plugin != nullptr; plugin = plugin->NextSiblingElement("class")) {
      if (attribute(*plugin, "base_class_type") != base) continue;
      const std::string type = attribute(*plugin, "type"), name = attribute(*plugin, "name");
      const auto* const text = plugin->FirstChildElement("description");
      const char* const description = text == nullptr ? nullptr : text->GetText();
      found.emplace(name.empty() ? type : name,
                    PluginDescription{type, package, description == nullptr ? "" : description,
                                      prefix + "/lib/lib" + attribute(*library, "path")});
    }
  }
}

/// The plugins that the packages in the ament index describe.
inline PluginDescriptions describe_plugins(const std::string& category, const std::string& base) {
  const std::string resource = category + "__pluginlib__plugin";
  PluginDescriptions found;
  namespace ament_index = inverse_dynamics_solver::ament_index;
  for (const auto& [package, prefix] : ament_index::resources(resource)) {
    std::ifstream files(ament_index::entry(prefix, resource, package));
    for (std::string file; std::getline(files, file);) {
      if (!file.empty()) read_descriptions(prefix + "/" + file, prefix, package, base, found);
    }
  }
  return found;
}

/// Opens a library, for good: its objects and exceptions may live until the end of the program.
inline void* function_of(const std::string& path, const char* name) {
#ifdef __APPLE__
  const std::string file = path + ".dylib";
#else
  const std::string file = path + ".so";
#endif
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw PluginlibException(dlerror());
  void* const function = dlsym(library, name);
  if (function == nullptr) {
    throw PluginlibException(file +
                             " registers its plugins with ROS's class_loader alone, and this "
                             "program was built without ROS; register them with "
                             "INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN");
  }
  return function;
}

/// What is used of pluginlib's loader; Base is the class of the plugins.
template <class Base>
class ClassLoader {
 public:
  ClassLoader(const std::string& category, const std::string& base)
      : plugins_(describe_plugins(category, base)) {}

  std::vector<std::string> getDeclaredClasses() const {
    std::vector<std::string> names;
    for (const auto& [name, plugin] : plugins_) names.push_back(name);
    return names;
  }

  std::string getClassDescription(const std::string& name) const {
    return plugins_.at(name).description;
  }
  std::string getClassPackage(const std::string& name) const { return plugins_.at(name).package; }
  std::string getClassType(const std::string& name) const { return plugins_.at(name).type; }

  std::unique_ptr<Base> createUniqueInstance(const std::string& name) const {
    const PluginDescription& plugin = plugins_.at(name);
    using Make = void* (*)(const char*, const char*);
    const auto make =
        reinterpret_cast<Make>(function_of(plugin.library, "inverse_dynamics_make_plugin"));
    void* const made = make(typeid(Base).name(), plugin.type.c_str());
    if (made == nullptr) throw CreateClassException("no class " + plugin.type);
    return std::unique_ptr<Base>(static_cast<Base*>(made));
  }

 private:
  PluginDescriptions plugins_;
};

}  // namespace without_ros
}  // namespace pluginlib
