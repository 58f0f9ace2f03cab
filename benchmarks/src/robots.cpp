// SPDX-License-Identifier: Apache-2.0
#include "robots.hpp"

#include <fstream>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "generated_chain.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

std::string pathOf(const std::string& file) {
  return inverse_dynamics_solver::installedPackageShare("inverse_dynamics_robots") + "/" + file;
}

std::string textOf(const std::string& file) {
  const std::string path = pathOf("urdf/" + file);
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path + ": can't be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

std::vector<Robot> realRobots() {
  return {{"ur10", textOf("ur10.urdf")}, {"panda", textOf("panda.urdf")}};
}

std::string feasiblePandaFile() { return pathOf("models/franka_gaz2019_feasible.yaml"); }

std::vector<Robot> robots() {
  std::vector<Robot> all = realRobots();
  for (const int n : {1, 2, 3, 6, 7, 10, 15, 20, 30}) {
    all.push_back({"mixed" + std::to_string(n), generatedChain(n, Joints::kTurningAndSliding)});
  }
  for (const int n : {6, 7}) {
    all.push_back({"turning" + std::to_string(n), generatedChain(n, Joints::kTurning)});
  }
  return all;
}

}  // namespace inverse_dynamics_benchmarks
