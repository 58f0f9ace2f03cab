// SPDX-License-Identifier: Apache-2.0
//
// Lists the installed shapes, then loads those that are named, and tells where a package is.

#include <ament_index.hpp>
#include <exception>
#include <iostream>
#include <pluginlib/class_loader.hpp>
#include <string>

#include "shape.hpp"

int main(int count, char** arguments) try {
  const pluginlib::ClassLoader<shapes::Shape> loader("shapes", "shapes::Shape");
  for (const std::string& name : loader.getDeclaredClasses()) {
    std::cout << name << " of " << loader.getClassPackage(name) << ", " << loader.getClassType(name)
              << ": " << loader.getClassDescription(name) << "\n";
  }
  for (int i = 1; i < count; ++i) {
    try {
      std::cout << loader.createUniqueInstance(arguments[i])->corners() << " corners\n";
    } catch (const pluginlib::CreateClassException& e) {
      std::cout << "no such class: " << e.what() << "\n";
    } catch (const pluginlib::PluginlibException& e) {
      std::cout << "no such library: " << e.what() << "\n";
    }
  }
  std::cout << inverse_dynamics_solver::ament_index::packageShare("shapes") << "\n";
} catch (const std::exception& e) {
  std::cout << "error: " << e.what() << "\n";
}
