// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"

#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

constexpr double kRounding = 1e-9;
using Strings = std::vector<std::string>;

class FeedForwardControllerTest : public ChainedFixture<FeedForwardController> {
 protected:
  void SetUp() override { hardware.set(q, qd); }

  static Parameters with(const Strings& interfaces) {
    Parameters parameters = good();
    parameters["reference_interfaces"] = rclcpp::ParameterValue(interfaces);
    parameters["friction.source"] = rclcpp::ParameterValue("none");
    return parameters;
  }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  const Eigen::VectorXd qd = vec({0.1, -0.2, 0.3, 0.2, -0.1, 0.4});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  const Eigen::VectorXd q_ref = q + vec({0.002, -0.001, 0.003, 0.001, 0.002, -0.003});
  const Eigen::VectorXd qd_ref = vec({0.2, -0.1, 0.1, 0.3, 0.2, 0.1});
  const Eigen::VectorXd qdd_ref = vec({0.5, -0.5, 1.0, 0.2, -0.4, 0.3});
  const Eigen::VectorXd pid = vec({1.0, -2.0, 3.0, -4.0, 5.0, -6.0});
};

TEST_F(FeedForwardControllerTest, AddsTheTorqueOfTheReferenceToOwnGains) {
  Parameters parameters = with({"position", "velocity", "acceleration"});
  parameters["gains.p"] = rclcpp::ParameterValue(std::vector<double>{100.0});
  parameters["gains.d"] = rclcpp::ParameterValue(std::vector<double>{6, 5, 4, 3, 2, 1});
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd feedback =
      100.0 * (q_ref - q) + vec({6, 5, 4, 3, 2, 1}).cwiseProduct(qd_ref - qd);
  const Eigen::VectorXd expected = solver()->getTorques(q_ref, qd_ref, qdd_ref) + feedback;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, AddsTheTorqueOfTheReferenceToTheEffortOfAnother) {
  ASSERT_TRUE(start(with({"position", "velocity", "acceleration", "effort"}))) << log.text();
  EXPECT_EQ(referenceCount(), 24U);
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);  // nobody has written an effort yet
  const Eigen::VectorXd model = solver()->getTorques(q_ref, qd_ref, qdd_ref);
  EXPECT_LT((hardware.effort() - model).norm(), kRounding);
  setReferences(3, pid);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - model - pid).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, WithEffortAloneTheModelIsTakenAtTheMeasuredState) {
  Parameters parameters = with({"effort"});
  parameters.erase("friction.source");
  ASSERT_TRUE(start(parameters)) << log.text();
  setReferences(0, pid);
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected = solver()->getTorques(q, qd, zero) + pid;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, TakesASolverWhoseInertiaIsNotPhysicalAndItsFriction) {
  Parameters parameters = with({"position", "velocity", "acceleration"});
  parameters["plugin_name"] = rclcpp::ParameterValue(kUr10);
  parameters["friction.source"] = rclcpp::ParameterValue("reference_velocity");
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);  // all velocities beyond `friction.blend`
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd expected = solver(kUr10)->getTorques(q_ref, qd_ref, qdd_ref);
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, AnEffortThatIsNanGivesTheSafeTorqueAndThenGivesUp) {
  ASSERT_TRUE(start(with({"effort"}))) << log.text();
  setReferences(0, pid);
  EXPECT_EQ(update(), return_type::OK);
  setReference(1, 0, kNan);
  const Eigen::VectorXd braked = solver()->getGravityVector(q) - 4.0 * qd;
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - braked).norm(), kRounding);
  for (int k = 0; k < 30; ++k) update();
  setReference(1, 0, 0.0);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - braked).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, AfterALostReferenceTheArmIsBrakedWhereNothingFeedsBack) {
  ASSERT_TRUE(start(with({"position", "velocity", "acceleration", "effort"}))) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  setReferences(3, pid);
  EXPECT_EQ(update(), return_type::OK);
  setReference(0, 0, kNan);
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd braked = solver()->getGravityVector(q) - 4.0 * qd;
  EXPECT_LT((hardware.effort() - braked).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, AfterALostReferenceOwnGainsFollowTheStop) {
  Parameters parameters = with({"position", "velocity", "acceleration"});
  parameters["gains.p"] = rclcpp::ParameterValue(std::vector<double>{100.0});
  parameters["gains.d"] = rclcpp::ParameterValue(std::vector<double>{5.0});
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  update();
  setReference(0, 0, kNan);
  for (int k = 0; k < 300; ++k) update();
  const Eigen::VectorXd rest = q_ref + qd_ref * (0.5 * 0.3 / 2.0);
  const Eigen::VectorXd expected =
      solver()->getTorques(rest, zero, zero) + 100.0 * (rest - q) - 5.0 * qd;
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, OwnGainsChangeWhileItRuns) {
  ASSERT_TRUE(start(with({"position", "velocity", "acceleration"}))) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_EQ(set("gains.p", rclcpp::ParameterValue(std::vector<double>{100.0})), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  const Eigen::VectorXd expected =
      solver()->getTorques(q_ref, qd_ref, qdd_ref) + 100.0 * (q_ref - q);
  EXPECT_LT((hardware.effort() - expected).norm(), kRounding);
}

TEST_F(FeedForwardControllerTest, FrictionOfAReferenceNeedsItsVelocity) {
  Parameters parameters = with({"effort"});
  parameters["friction.source"] = rclcpp::ParameterValue("reference_velocity");
  EXPECT_FALSE(configure(parameters));
  EXPECT_TRUE(
      log.has("ERROR: parameter 'friction.source': no such velocity: expected none or "
              "measured_velocity, as reference_interfaces has no velocity, got "
              "reference_velocity; set one of them"))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
