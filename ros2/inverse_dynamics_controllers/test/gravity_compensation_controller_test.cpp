// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"

#include <rclcpp/version.h>

#include <chrono>

#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

constexpr double kRounding = 1e-9;

class GravityCompensationControllerTest : public ControllerFixture<GravityCompensationController> {
 protected:
  void SetUp() override { hardware.set(q, qd); }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  const Eigen::VectorXd qd = vec({0.1, -0.2, 0.3, 0.2, -0.1, 0.4});
};

TEST_F(GravityCompensationControllerTest, CommandsGravityAndDamping) {
  ASSERT_TRUE(configure(good()) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected = solver()->getGravityVector(q) - 4.0 * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
  EXPECT_EQ(log.text(), "");
}

TEST_F(GravityCompensationControllerTest, ActivationAlreadyCarriesTheArm) {
  ASSERT_TRUE(configure(good()) && activate()) << log.text();
  const Eigen::VectorXd expected = solver()->getGravityVector(q) - 4.0 * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, TakesOverFromTheLastEffortsAtTheSameState) {
  Parameters parameters = good();
  parameters["limits.effort_rate"] = rclcpp::ParameterValue(std::vector<double>{1000.0});
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  const auto restart = [this](const Eigen::VectorXd& position) {
    controller.get_node()->deactivate();
    EXPECT_EQ(hardware.effort(), Eigen::VectorXd::Zero(6));
    hardware.set(position, qd);
    EXPECT_TRUE(activate()) << log.text();
  };
  const Eigen::VectorXd there = q + Eigen::VectorXd::Constant(6, 0.5);
  const auto safe = [&](const Eigen::VectorXd& position) {
    return Eigen::VectorXd(solver()->getGravityVector(position) - 4.0 * qd);
  };
  restart(there);
  EXPECT_LT((hardware.effort() - safe(there)).norm(), kRounding);
  hardware.set(q, qd);
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd last = hardware.effort();
  EXPECT_GT((last - safe(q)).norm(), 1.0);
  restart(q);
  EXPECT_EQ(hardware.effort(), last);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - last).cwiseAbs().maxCoeff(), 1.0 + kRounding);
}

TEST_F(GravityCompensationControllerTest, TakesOverWithoutAMeasuredState) {
  ASSERT_TRUE(configure(good()) && activate()) << log.text();
  hardware.q[2] = hardware.qd[2] = kNan;
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd last = hardware.effort();
  controller.get_node()->deactivate();
  EXPECT_TRUE(activate()) << log.text();
  for (int k = 0; k < 100; ++k) EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - last).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, TakesASolverWhoseInertiaIsNotPhysical) {
  Parameters parameters = good();
  parameters["plugin_name"] = rclcpp::ParameterValue(kUr10);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected = solver(kUr10)->getGravityVector(q) - 4.0 * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, FrictionIsCompensatedBeyondTheDeadBand) {
  Parameters parameters = good();
  parameters["plugin_name"] = rclcpp::ParameterValue(kUr10);
  parameters["friction.source"] = rclcpp::ParameterValue("measured_velocity");
  parameters["friction.dead_band"] = rclcpp::ParameterValue(0.15);
  parameters["friction.blend"] = rclcpp::ParameterValue(1e-3);
  parameters["friction.scale"] = rclcpp::ParameterValue(0.5);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd friction =
      0.5 * solver(kUr10)->getFrictionVector(qd).cwiseProduct(vec({0, 1, 1, 1, 0, 1}));
  const Eigen::VectorXd expected = solver(kUr10)->getGravityVector(q) - 4.0 * qd + friction;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, DampingCanBeMadeOfARate) {
  Parameters parameters = good();
  parameters.erase("damping.values");
  parameters["damping.rate"] = rclcpp::ParameterValue(0.01);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected =
      solver()->getGravityVector(q) - 0.01 * solver()->getInertiaMatrix(q) * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, DampingChangesWhileItRuns) {
  using Numbers = std::vector<double>;
  const auto damped = [&](const Eigen::VectorXd& braking) {
    return Eigen::VectorXd(solver()->getGravityVector(q) - braking);
  };
  Parameters parameters = good();
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_EQ(set("damping.values", rclcpp::ParameterValue(Numbers{6, 5, 4, 3, 2, 1})), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  EXPECT_LT((hardware.effort() - damped(vec({6, 5, 4, 3, 2, 1}).cwiseProduct(qd))).norm(),
            kRounding);

  // By the rate instead of the numbers, and another rate.
  const Eigen::VectorXd momentum = solver()->getInertiaMatrix(q) * qd;
  EXPECT_EQ(set("damping.rate", rclcpp::ParameterValue(0.01)), "");
  EXPECT_EQ(set("damping.values", rclcpp::ParameterValue(Numbers{})), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  EXPECT_LT((hardware.effort() - damped(0.01 * momentum)).norm(), kRounding);
  EXPECT_EQ(set("damping.rate", rclcpp::ParameterValue(0.02)), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  EXPECT_LT((hardware.effort() - damped(0.02 * momentum)).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, DampingThatDoesNotFitIsRefusedAndTheOldOneStays) {
  using Numbers = std::vector<double>;
  Parameters parameters = good();
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd before = hardware.effort();
  const auto refused = [this](const std::string& name, const rclcpp::ParameterValue& value,
                              const std::string& why) {
    const std::string reason = set(name, value);
    EXPECT_NE(reason.find(why), std::string::npos) << name << ": " << reason;
  };
  refused("damping.values", rclcpp::ParameterValue(Numbers{1.0, 2.0}),
          "parameter 'damping.values': wrong size: expected 6 numbers, or one for all, got 2; ");
#if RCLCPP_VERSION_GTE(29, 0, 0)  // newer than jazzy: rclcpp compares arrays with ranges itself
  refused("damping.values", rclcpp::ParameterValue(Numbers{kNan}), "floating point range");
#else
  refused("damping.values", rclcpp::ParameterValue(Numbers{kNan}),
          "parameter 'damping.values': joint shoulder_pan_joint: wrong value: expected a finite "
          "number, 0 or more [N m s/rad], got nan; ");
#endif
  EXPECT_NE(set("damping.values", rclcpp::ParameterValue(Numbers{-1.0})), "");
  EXPECT_NE(set("damping.values", rclcpp::ParameterValue(Numbers{1e6})), "");
  EXPECT_NE(set("damping.rate", rclcpp::ParameterValue(0.0)), "");
  // Numbers take precedence: the rate counts, and is refused, once there are none.
  EXPECT_EQ(set("damping.rate", rclcpp::ParameterValue(1e6)), "");
  refused("damping.values", rclcpp::ParameterValue(Numbers{}), "at most 1 / period, ");
  const auto fails = [this] { return update() != return_type::OK; };
  EXPECT_FALSE(spinUntil(fails, std::chrono::milliseconds(300)));
  EXPECT_EQ(hardware.effort(), before);
}

TEST_F(GravityCompensationControllerTest, OtherNamesOfTheHardwareAreTakenInTheOrderOfTheChain) {
  std::vector<std::string> left;
  for (const std::string& joint : ur10Joints()) left.push_back("left_" + joint);
  Parameters parameters = good();
  parameters["joints"] = rclcpp::ParameterValue(left);
  parameters["limits.effort"] = rclcpp::ParameterValue(std::vector<double>{100.0});
  hardware = FakeHardware(left);
  hardware.set(q, qd);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected = solver()->getGravityVector(q) - 4.0 * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(GravityCompensationControllerTest, CommandsMayHaveOtherNamesThanStates) {
  Parameters parameters = good();
  std::vector<std::string> names;
  for (const std::string& joint : ur10Joints()) names.push_back("admittance/" + joint);
  parameters["command_joints"] = rclcpp::ParameterValue(names);
  parameters["command_interface"] = rclcpp::ParameterValue("torque");
  ASSERT_TRUE(configure(parameters)) << log.text();
  const auto commands = controller.command_interface_configuration().names;
  ASSERT_EQ(commands.size(), 6u);
  EXPECT_EQ(commands[2], "admittance/elbow_joint/torque");
  EXPECT_EQ(controller.state_interface_configuration().names[0], "shoulder_pan_joint/position");
  EXPECT_FALSE(activate());
  EXPECT_TRUE(
      log.has("ERROR: command interface: missing: expected "
              "admittance/shoulder_pan_joint/torque"))
      << log.text();
}

TEST_F(GravityCompensationControllerTest, AsManyCommandsAsJoints) {
  Parameters parameters = good();
  parameters["command_joints"] = rclcpp::ParameterValue(std::vector<std::string>{"elbow_joint"});
  EXPECT_FALSE(configure(parameters));
  EXPECT_TRUE(log.has("ERROR: parameter 'command_joints': wrong number of names: expected 6"))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
