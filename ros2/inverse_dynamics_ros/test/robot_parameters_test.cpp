// SPDX-License-Identifier: Apache-2.0

#include "robot_parameters.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <optional>

namespace inverse_dynamics_ros {
namespace {

namespace fs = std::filesystem;
using inverse_dynamics_solver::Parameters;

constexpr const char* kUrdf = R"(<robot name="lift">
  <link name="base"/>
  <link name="cart"><inertial><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
</robot>
)";

/// A run configuration and its description, gone after the test.
class RobotParameters : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "robot_parameters_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    std::ofstream(folder_ / "arm.urdf") << kUrdf;
    std::ofstream(file()) << "schema: 1\nname: arm\ndescription: an arm\n"
                             "plugin: rigid_body_inverse_dynamics_solver/"
                             "InverseDynamicsSolverRigidBody\n"
                             "urdf: arm.urdf\njoints: [slider]\neffort: current\n"
                             "drive_gains: [3]\ngravity: [0, 0, -2]\n"
                             "accelerations: {method: low-pass, cutoff: 7}\n"
                             "parameters: {batch_threads: 2}\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file() const { return folder_ / "arm.yaml"; }

  fs::path folder_;
};

TEST_F(RobotParameters, AreARunConfiguration) {
  const NodeRobot robot(Parameters{{"robot", file()}});
  EXPECT_EQ(robot.name(robot.description()), "arm");
  EXPECT_EQ(robot.configuration().cutoff, 7);
  EXPECT_EQ(robot.description(), kUrdf);
  const auto solver = robot.makeSolver(robot.description());
  EXPECT_EQ(solver->jointNames(), std::vector<std::string>{"slide"});
  EXPECT_DOUBLE_EQ(solver->getGravityVector(Eigen::VectorXd::Zero(1))[0], 4.0);
  EXPECT_EQ(torqueUnits(*solver), std::vector<std::string>{"N"});
}

TEST_F(RobotParameters, GivenBesideItReplaceWhatItSays) {
  const NodeRobot robot(Parameters{{"robot", file()},
                                   {"effort", std::string("torque")},
                                   {"joints", std::vector<std::string>{"s"}},
                                   {"accelerations", std::string("given")},
                                   {"drive_gains", std::vector<double>{}},
                                   {"ids.gravity", std::vector<double>{0, 0, -1}},
                                   {"input_bag", std::string("bag")}});
  EXPECT_EQ(robot.configuration().effort, "torque");
  EXPECT_EQ(robot.configuration().joints, std::vector<std::string>{"s"});
  try {
    inverse_dynamics_evaluation::recordedNames(robot.configuration(), {"a", "b"});
    FAIL() << "one name for two joints";
  } catch (const inverse_dynamics_evaluation::ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 29), "parameter 'joints': expected ");
  }
  EXPECT_EQ(robot.configuration().cutoff, std::nullopt);
  EXPECT_EQ(robot.configuration().drive_gains, std::vector<double>{3}) << "empty: not given";
  const auto solver = robot.makeSolver(robot.description());
  EXPECT_DOUBLE_EQ(solver->getGravityVector(Eigen::VectorXd::Zero(1))[0], 2.0);
  const NodeRobot described(
      Parameters{{"robot", file()}, {"robot_description", std::string("<robot/>")}});
  EXPECT_EQ(described.description(), "<robot/>");
}

TEST_F(RobotParameters, AreEnoughWithoutARunConfiguration) {
  const NodeRobot robot(Parameters{{"plugin_name", std::string("rigid_body_inverse_dynamics_solver/"
                                                               "InverseDynamicsSolverRigidBody")},
                                   {"robot_description", std::string(kUrdf)},
                                   {"ids.tip", std::string("cart")}});
  EXPECT_EQ(robot.configuration().file, "");
  EXPECT_EQ(robot.makeSolver(robot.description())->jointCount(), 1);
  EXPECT_EQ(robot.name(robot.description()), "lift");
}

TEST_F(RobotParameters, NameTheEndsOfTheChain) {
  const NodeRobot robot(Parameters{{"robot", file()}});
  EXPECT_EQ(robot.rootLink(robot.description()), "base");
  EXPECT_EQ(robot.tipLink(robot.description()), "cart");
  const NodeRobot stated(Parameters{
      {"robot", file()}, {"ids.root", std::string("floor")}, {"ids.tip", std::string("hand")}});
  EXPECT_EQ(stated.rootLink(robot.description()), "floor");
  EXPECT_EQ(stated.tipLink(robot.description()), "hand");
  EXPECT_EQ(stated.tipLink(robot.description(), {"left", "right"}), "left");
  const NodeRobot listed(
      Parameters{{"robot", file()}, {"ids.tip", std::vector<std::string>{"hand"}}});
  EXPECT_EQ(listed.tipLink(robot.description()), "hand");
  const NodeRobot starred(Parameters{{"robot", file()}, {"ids.tip", std::string("*")}});
  EXPECT_EQ(starred.tipLink(robot.description()), "cart");
  const NodeRobot of_a_model(Parameters{{"plugin_name", std::string("package/Class")}});
  EXPECT_EQ(of_a_model.rootLink(""), "");
  EXPECT_EQ(of_a_model.tipLink("<robot"), "");
  const std::string forked = std::string(kUrdf).replace(
      std::string(kUrdf).find("</robot>"), 8,
      "<link name='lamp'/><joint name='fixed' type='fixed'><parent link='cart'/><child "
      "link='lamp'/></joint><link name='hook'/><joint name='other' type='fixed'><parent "
      "link='cart'/><child link='hook'/></joint></robot>");
  EXPECT_EQ(of_a_model.rootLink(forked), "base");
  EXPECT_EQ(of_a_model.tipLink(forked), "") << "lamp or hook";
  const NodeRobot elsewhere(Parameters{{"plugin_name", std::string("package/Class")},
                                       {"ids.root", std::string("floor")}});
  EXPECT_EQ(elsewhere.tipLink(forked), "");
}

TEST_F(RobotParameters, AreCheckedByWhoeverKnowsThem) {
  EXPECT_THROW(NodeRobot(Parameters{{"robot", std::string("none.yaml")}}),
               inverse_dynamics_evaluation::ConfigurationError);
  EXPECT_THROW(NodeRobot(Parameters{{"robot", file()}, {"effort", 1.0}}),
               inverse_dynamics_solver::InvalidParameterValueException);
  const NodeRobot misspelt(Parameters{{"robot", file()}, {"ids.gravty", 1.0}});
  try {
    misspelt.makeSolver(misspelt.description());
    FAIL() << "a parameter that the solver doesn't know";
  } catch (const inverse_dynamics_solver::InvalidParameterValueException& error) {
    EXPECT_NE(std::string(error.what()).find("ids.gravty"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace inverse_dynamics_ros
