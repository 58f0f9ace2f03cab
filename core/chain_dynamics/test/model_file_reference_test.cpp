// SPDX-License-Identifier: Apache-2.0

// The model files of this project against those that they were taken from; what they compute is judged by the
// solver's tests.

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "model_file_texts.hpp"

namespace chain_dynamics::model_file_reference_test {

// The file's figures must be those of the source, digit by digit.
TEST(ModelFileReference, FiguresAreThoseOfTheSource) {
  if (dataFolder().empty()) {
    GTEST_SKIP() << "IDS_DATA_DIR isn't set: it names the folder with models/*.yaml";
  }
  for (const std::string name : {"franka_gaz2019_feasible", "franka_inria_identified"}) {
    const YAML::Node source = YAML::LoadFile(dataFolder() + "/models/" + name + ".yaml");
    const Model robot = modelFromFile(kRobots + "/models/" + name + ".yaml");
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_EQ(robot.chain.links()[i].toVector(), vectorOf(source["links"][i])) << name << i;
      EXPECT_EQ(robot.chain.joints()[i].limits.lower,
                source["limits"]["position_lower"][i].as<double>());
      EXPECT_EQ(robot.chain.joints()[i].limits.effort, source["limits"]["effort"][i].as<double>());
    }
  }
  const YAML::Node ur10 = YAML::LoadFile(dataFolder() + "/models/ur10_identified.yaml");
  const Model robot = modelFromFile(kRobots + "/models/ur10_identified.yaml");
  EXPECT_EQ(robot.drive_gains, vectorOf(ur10["drive_gains"]));
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t i = 0; i < 6; ++i) {
      const Eigen::VectorXd links = vectorOf(ur10["rows"][j]["links"][i]);
      EXPECT_LT(difference(robot.row_parameters[j][i].toVector(),
                           robot.drive_gains[static_cast<Eigen::Index>(j)] * links),
                1e-15)
          << j << " " << i;
    }
  }
}

}  // namespace chain_dynamics::model_file_reference_test
