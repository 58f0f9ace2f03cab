// SPDX-License-Identifier: Apache-2.0
#include "simulated_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <hardware_interface/component_parser.hpp>
#include <inverse_dynamics_controllers/ros2_control_compatibility.hpp>
#include <inverse_dynamics_controllers/testing/captured_log.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <rclcpp/duration.hpp>
#include <rclcpp/time.hpp>

namespace inverse_dynamics_simulation {
namespace {

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;
using inverse_dynamics_controllers::CapturedLog;
using inverse_dynamics_controllers::setValue;
using inverse_dynamics_controllers::valueOf;

constexpr double kPeriod = 2e-3;  // s

/// A rod of 1 m and a slider along it. What a test changes stands in braces.
struct Description {
  std::string visual, commands = R"(<command_interface name="effort"/>)", initial = "0.0",
                      parameters;

  std::string text() const {
    return R"(<robot name="arm"><link name="base"/>
      <link name="rod"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
        <inertia ixx="0.01" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>)" +
           visual + R"(</link>
      <link name="tip"><inertial><mass value="0.1"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="swing" type="revolute"><parent link="base"/><child link="rod"/>
        <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="100" velocity="3"/></joint>
      <joint name="wrist" type="fixed"><parent link="rod"/><child link="tip"/>
        <origin xyz="1 0 0"/></joint>
      <ros2_control name="test" type="system"><hardware>
        <plugin>inverse_dynamics_simulation/SimulatedArm</plugin>)" +
           parameters + R"(</hardware><joint name="swing">)" + commands +
           R"(<state_interface name="position"><param name="initial_value">)" + initial +
           R"(</param></state_interface></joint></ros2_control></robot>)";
  }

  static std::string parameter(const std::string& name, const std::string& value) {
    return "<param name=\"" + name + "\">" + value + "</param>";
  }
};

class SimulatedArmTest : public ::testing::Test {
 protected:
  bool init(const Description& description) {
    const auto info = hardware_interface::parse_control_resources_from_urdf(description.text());
#ifdef INVERSE_DYNAMICS_SIMULATION_HAS_COMPONENT_PARAMS
    hardware_interface::HardwareComponentInterfaceParams params;
    params.hardware_info = info.at(0);
    return arm.on_init(params) == CallbackReturn::SUCCESS;
#else
    return arm.on_init(info.at(0)) == CallbackReturn::SUCCESS;
#endif
  }

  void expectRefused(const Description& description, const std::string& text) {
    EXPECT_FALSE(init(description));
    EXPECT_TRUE(log.has("ERROR: test: " + text)) << log.text();
  }

  // The effort for 1 s, as a controller that has claimed it; where the joint is then.
  double positionAfter(double effort) {
    auto commands = arm.export_command_interfaces();
    auto states = arm.export_state_interfaces();
    arm.perform_command_mode_switch({"swing/effort"}, {});
    EXPECT_TRUE(setValue(commands.at(0), effort));
    for (double t = 0; t < 1; t += kPeriod) {
      EXPECT_EQ(arm.write(rclcpp::Time(0), rclcpp::Duration::from_seconds(kPeriod)),
                return_type::OK);
    }
    arm.read(rclcpp::Time(0), rclcpp::Duration::from_seconds(kPeriod));
    return valueOf(states.at(0));
  }

  CapturedLog log;
  SimulatedArm arm;
};

constexpr double kRounding = 1e-9;
constexpr double kWeight = (2.0 * 0.5 + 0.1 * 1.0) * 9.81;  // N m: what carries the arm at 0

TEST_F(SimulatedArmTest, StaysWhereItsWeightIsCarriedAndFallsOtherwise) {
  ASSERT_TRUE(init({})) << log.text();
  EXPECT_NEAR(positionAfter(-kWeight), 0.0, kRounding);
  EXPECT_GT(positionAfter(0.0), 0.5);
}

TEST_F(SimulatedArmTest, CarriesAPayloadOfWhichTheDescriptionKnowsNothing) {
  Description description;
  description.parameters =
      Description::parameter("payload", "2.0") + Description::parameter("payload_link", "tip");
  ASSERT_TRUE(init(description)) << log.text();
  EXPECT_NEAR(positionAfter(-(kWeight + 2.0 * 9.81)), 0.0, kRounding);
}

TEST_F(SimulatedArmTest, RefusesAnEffortThatIsNotFinite) {
  ASSERT_TRUE(init({})) << log.text();
  auto commands = arm.export_command_interfaces();
  arm.perform_command_mode_switch({"swing/effort"}, {});
  setValue(commands.at(0), std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(arm.write(rclcpp::Time(0), rclcpp::Duration::from_seconds(kPeriod)),
            return_type::ERROR);
  EXPECT_TRUE(log.has("ERROR: joint swing: an effort of NaN or infinity was commanded"))
      << log.text();
}

TEST_F(SimulatedArmTest, RefusesOtherCommandInterfacesThanEffort) {
  Description description;
  description.commands =
      R"(<command_interface name="position"/><command_interface name="effort"/>)";
  expectRefused(description,
                "joint swing: command_interface: expected effort alone, got position, effort");
}

TEST_F(SimulatedArmTest, RefusesAJointWithoutACommandInterface) {
  Description description;
  description.commands = "";
  expectRefused(description, "joint swing: command_interface: expected effort alone, got none");
}

TEST_F(SimulatedArmTest, RefusesAnInitialValueThatIsNoNumber) {
  Description description;
  description.initial = "1.2rad";
  expectRefused(description,
                "joint swing: initial_value of position: expected a number [rad], got '1.2rad'");
}

// ros2_control itself refuses it from jazzy on, when it reads the description.
TEST_F(SimulatedArmTest, RefusesAJointThatCannotMove) {
  try {
    MujocoArm({Description().text()}, {"wrist"});
    FAIL() << "nothing was refused";
  } catch (const inverse_dynamics_solver::InvalidRobotDescriptionException& error) {
    EXPECT_NE(std::string(error.what())
                  .find("robot description: MuJoCo refuses it: got no movable "
                        "joint 'wrist'; "),
              std::string::npos)
        << error.what();
  }
}

TEST_F(SimulatedArmTest, RefusesAMeshThatIsMissing) {
  Description description;
  description.visual =
      R"(<collision><geometry><mesh filename="package://arm/nowhere.stl"/></geometry></collision>)";
  expectRefused(description, "robot description: MuJoCo refuses it: got ");
  EXPECT_TRUE(log.has("nowhere.stl")) << log.text();
  EXPECT_TRUE(log.has("; simple shapes instead of meshes are understood")) << log.text();
}

TEST_F(SimulatedArmTest, RefusesAPayloadThatIsNoMass) {
  Description description;
  description.parameters = Description::parameter("payload", "heavy");
  expectRefused(description, "parameter payload: expected a number [kg], got 'heavy'");
  description.parameters = Description::parameter("payload", "-1");
  expectRefused(description, "parameter payload: expected a mass [kg], got '-1'");
}

TEST_F(SimulatedArmTest, RefusesAPayloadOnALinkThatIsNotThere) {
  Description description;
  description.parameters =
      Description::parameter("payload", "2.0") + Description::parameter("payload_link", "hand");
  expectRefused(description,
                "robot description: MuJoCo refuses it: got no link 'hand' that could carry the "
                "payload; ");
}

}  // namespace
}  // namespace inverse_dynamics_simulation
