// SPDX-License-Identifier: Apache-2.0
#include "robots.hpp"

#include <cstddef>
#include <fstream>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
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

Robot twoPandas() {
  const std::string panda = textOf("panda.urdf");
  const std::size_t begin = panda.find('>', panda.find("<robot")) + 1;
  const std::string content = panda.substr(begin, panda.rfind("</robot>") - begin);
  std::string urdf =
      "<robot name='two_pandas'><link name='base'/><link name='torso'><inertial><mass value='20'/>"
      "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='0.5'/></inertial></link>"
      "<joint name='waist' type='continuous'><parent link='base'/><child link='torso'/>"
      "<axis xyz='0 0 1'/></joint>";
  for (const auto& [side, y, roll] :
       {std::tuple("left", "0.2", "-1"), std::tuple("right", "-0.2", "1")}) {
    urdf += std::regex_replace(content, std::regex("fer_"), std::string(side) + "_");
    urdf += std::string("<joint name='") + side + "_mount' type='fixed'><parent link='torso'/>" +
            "<child link='" + side + "_link0'/><origin xyz='0 " + y + " 0.5' rpy='" + roll +
            " 0 0'/></joint>";
  }
  return {"two_pandas", urdf + "</robot>"};
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
