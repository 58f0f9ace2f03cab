// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"

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
  parameters["period"] = rclcpp::ParameterValue(kPeriod);
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd damping =
      0.01 * solver()->getInertiaMatrix(Eigen::VectorXd::Zero(6)).diagonal();
  const Eigen::VectorXd expected = solver()->getGravityVector(q) - damping.cwiseProduct(qd);
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
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

}  // namespace
}  // namespace inverse_dynamics_controllers
