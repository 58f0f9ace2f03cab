// SPDX-License-Identifier: Apache-2.0

// Other people's values: the model files of this project against those that they were taken from.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "model_file_texts.hpp"

namespace chain_dynamics::model_file_reference_test {

void expectReference(const std::string& model_file, const std::string& reference) {
  constexpr double kReference = 1e-10;  // greatest difference, in kg m^2, N m
  const Model robot = modelFromFile(kRobots + "/models/" + model_file);
  const Eigen::Index n = robot.chain.jointCount();
  const auto states = referenceStates(reference);
  ASSERT_EQ(states.size(), 25U);
  for (const ReferenceState& state : states) {
    Eigen::MatrixXd H(n, n);
    Eigen::VectorXd c(n), g(n), f(n), tau(n);
    dynamicComponents(robot, state.q, state.qd, H, c, g);
    frictionVector(robot, state.q, state.qd, f);
    torques(robot, state.q, state.qd, state.qdd, tau);
    EXPECT_LT(difference(H, state.H), kReference) << state.label;
    EXPECT_LT(difference(c, state.coriolis), kReference) << state.label;
    EXPECT_LT(difference(g, state.gravity), kReference) << state.label;
    EXPECT_LT(difference(f, state.friction), kReference) << state.label;
    EXPECT_LT(difference(tau + f, state.torques), kReference) << state.label;
  }
}

TEST(ModelFileReference, UR10IdentifiedIsTheSourcesModel) {
  expectReference("ur10_identified.yaml", "ur10.json");
}

TEST(ModelFileReference, FrankaInriaIdentifiedIsTheSourcesModel) {
  expectReference("franka_inria_identified.yaml", "franka_inria.json");
}

TEST(ModelFileReference, OnlyTheFeasibleModelIsPhysical) {
  EXPECT_FALSE(modelFromFile(kRobots + "/models/ur10_identified.yaml").inertiaIsPhysical());
  EXPECT_FALSE(modelFromFile(kRobots + "/models/franka_inria_identified.yaml").inertiaIsPhysical());
  const Model feasible = modelFromFile(kRobots + "/models/franka_gaz2019_feasible.yaml");
  EXPECT_TRUE(feasible.inertiaIsPhysical());
  EXPECT_TRUE(feasible.chain.warnings().empty());
}

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
