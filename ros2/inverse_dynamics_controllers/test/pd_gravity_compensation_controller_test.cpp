// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/pd_gravity_compensation_controller.hpp"

#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

constexpr double kRounding = 1e-9;
using Numbers = std::vector<double>;

class PdGravityCompensationControllerTest : public ChainedFixture<PdGravityCompensationController> {
 protected:
  void SetUp() override { hardware.set(q, qd); }

  static Parameters good() {
    Parameters parameters = ChainedFixture::good();
    parameters["gains.p"] = rclcpp::ParameterValue(Numbers{100.0});
    parameters["gains.d"] = rclcpp::ParameterValue(Numbers{6, 5, 4, 3, 2, 1});
    return parameters;
  }

  // tau = g + P e + D ed
  Eigen::VectorXd expected(const Eigen::VectorXd& wished_q, const Eigen::VectorXd& wished_qd,
                           double p = 100.0, const char* plugin = kKdl) const {
    return solver(plugin)->getGravityVector(q) + p * (wished_q - q) +
           vec({6, 5, 4, 3, 2, 1}).cwiseProduct(wished_qd - qd);
  }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  const Eigen::VectorXd qd = vec({0.1, -0.2, 0.3, 0.2, -0.1, 0.4});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  const Eigen::VectorXd q_ref = q + vec({0.002, -0.001, 0.003, 0.001, 0.002, -0.003});
  const Eigen::VectorXd qd_ref = vec({0.2, -0.1, 0.1, 0.3, 0.2, 0.1});
};

TEST_F(PdGravityCompensationControllerTest, CommandsGravityAndFeedback) {
  ASSERT_TRUE(start(good())) << log.text();
  EXPECT_EQ(referenceCount(), 12U);  // position and velocity
  setReferences(0, q_ref);
  setReferences(1, qd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref)).norm(), kRounding);
  EXPECT_EQ(log.text(), "");
}

TEST_F(PdGravityCompensationControllerTest, HoldsWhereItStartsUntilTheFirstReference) {
  hardware.set(q, zero);
  ASSERT_TRUE(start(good())) << log.text();
  hardware.set(q, qd);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q, zero)).norm(), kRounding);
}

TEST_F(PdGravityCompensationControllerTest, TakesASolverWhoseInertiaIsNotPhysical) {
  Parameters parameters = good();
  parameters["plugin_name"] = rclcpp::ParameterValue(kUr10);
  parameters["friction.source"] = rclcpp::ParameterValue("none");
  ASSERT_TRUE(start(parameters)) << log.text();
  setReferences(0, q_ref);
  setReferences(1, qd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, 100.0, kUr10)).norm(), kRounding);
}

TEST_F(PdGravityCompensationControllerTest, ALostReferenceStopsTheArm) {
  ASSERT_TRUE(start(good())) << log.text();
  setReferences(0, q_ref);
  setReferences(1, qd_ref);
  EXPECT_EQ(update(), return_type::OK);
  setReference(2, 0, kNan);
  for (int k = 0; k < 300; ++k) EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd rest = q_ref + qd_ref * (0.5 * 0.3 / 2.0);  // from 0.3 rad/s at 2 rad/s^2
  EXPECT_LT((hardware.effort() - expected(rest, zero)).norm(), kRounding);
}

TEST_F(PdGravityCompensationControllerTest, GainsChangeWhileItRuns) {
  ASSERT_TRUE(start(good())) << log.text();
  setReferences(0, q_ref);
  setReferences(1, qd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_EQ(set("gains.p", rclcpp::ParameterValue(Numbers{150.0})), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, 150.0)).norm(), kRounding);
}

TEST_F(PdGravityCompensationControllerTest, GainsAreNeeded) {
  Parameters parameters = good();
  parameters["gains.d"] = rclcpp::ParameterValue(Numbers{});
  EXPECT_FALSE(configure(parameters));
  EXPECT_TRUE(
      log.has("ERROR: parameter 'gains.d': wrong size: expected 6 numbers, or one for all, "
              "got 0; "))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
