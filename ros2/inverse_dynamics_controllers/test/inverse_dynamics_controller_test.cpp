// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"

#include <chrono>
#include <cmath>
#include <control_msgs/msg/joint_trajectory_controller_state.hpp>

#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

// Rounding of some hundreds of operations on torques of some hundred N m.
constexpr double kRounding = 1e-9;
constexpr double kFrequency = 5.0;  // rad/s

class InverseDynamicsControllerTest : public ChainedFixture<InverseDynamicsController> {
 protected:
  static Parameters good() {
    Parameters parameters = ChainedFixture::good();
    parameters["gains.natural_frequency"] = rclcpp::ParameterValue(std::vector<double>{kFrequency});
    return parameters;
  }

  // tau = H (qdd_ref + w^2 e + 2 w ed) + C qd + g
  Eigen::VectorXd expected(const Eigen::VectorXd& wished_q, const Eigen::VectorXd& wished_qd,
                           const Eigen::VectorXd& wished_qdd, double w = kFrequency) const {
    const Eigen::VectorXd acceleration =
        wished_qdd + w * w * (wished_q - q) + 2.0 * w * (wished_qd - qd);
    return solver()->getTorques(q, qd, acceleration);
  }

  // The same after t seconds of a stop: all joints together, the fastest with the default 2 rad/s^2.
  Eigen::VectorXd stopping(const Eigen::VectorXd& from_q, const Eigen::VectorXd& from_qd,
                           double t) const {
    const double T = from_qd.cwiseAbs().maxCoeff() / 2.0;
    if (t > T - 0.5 * kPeriod) return expected(from_q + from_qd * 0.5 * T, zero, zero);
    return expected(from_q + from_qd * (t * (1.0 - 0.5 * t / T)), from_qd * (1.0 - t / T),
                    -from_qd / T);
  }

  void SetUp() override { hardware.set(q, qd); }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  const Eigen::VectorXd qd = vec({0.1, -0.2, 0.3, 0.2, -0.1, 0.4});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  const Eigen::VectorXd q_ref = q + vec({0.002, -0.001, 0.003, 0.001, 0.002, -0.003});
  const Eigen::VectorXd qd_ref = vec({0.2, -0.1, 0.1, 0.3, 0.2, 0.1});
  const Eigen::VectorXd qdd_ref = vec({0.5, -0.5, 1.0, 0.2, -0.4, 0.3});
};

TEST_F(InverseDynamicsControllerTest, CommandsComputedTorque) {
  ASSERT_TRUE(start(good())) << log.text();
  EXPECT_EQ(referenceCount(), 18U);
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref)).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, StopsUntilTheFirstReference) {
  ASSERT_TRUE(start(good())) << log.text();
  for (int k = 1; k <= 300; ++k) {
    EXPECT_EQ(update(), return_type::OK);
    EXPECT_LT((hardware.effort() - stopping(q, qd, k * kPeriod)).norm(), kRounding);
  }
  EXPECT_EQ(log.text(), "");
}

TEST_F(InverseDynamicsControllerTest, AccelerationsMayBeLeftOut) {
  Parameters parameters = good();
  parameters["reference_interfaces"] =
      rclcpp::ParameterValue(std::vector<std::string>{"position", "velocity"});
  ASSERT_TRUE(start(parameters)) << log.text();
  setReferences(0, q_ref);
  setReferences(1, qd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, zero)).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, WhatTheRobotCompensatesIsLeftOut) {
  Parameters parameters = good();
  parameters["compensated_by_robot.gravity"] = rclcpp::ParameterValue(true);
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd without = expected(q_ref, qd_ref, qdd_ref) - solver()->getGravityVector(q);
  EXPECT_LT((hardware.effort() - without).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, EffortsStayWithinTheLimitsOfTheRobotDescription) {
  ASSERT_TRUE(start(good())) << log.text();
  setMotion(q, zero, Eigen::VectorXd::Constant(6, -1e3));
  EXPECT_EQ(update(), return_type::OK);
  const Eigen::VectorXd limits = vec({330.0, 330.0, 150.0, 56.0, 56.0, 56.0});
  EXPECT_TRUE((hardware.effort().cwiseAbs().array() <= limits.array()).all())
      << hardware.effort().transpose();
  EXPECT_EQ(std::abs(hardware.effort()[1]), 330.0);
}

class UnsoundReference : public InverseDynamicsControllerTest,
                         public ::testing::WithParamInterface<std::pair<std::size_t, double>> {};

TEST_P(UnsoundReference, NeverReachesTheHardwareAndStopsTheArmForGood) {
  ASSERT_TRUE(start(good())) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  const auto [interface, value] = GetParam();
  setReference(2, interface, value);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_EQ(update(), return_type::OK);
    EXPECT_LT((hardware.effort() - stopping(q_ref, qd_ref, k * kPeriod)).norm(), kRounding);
    setMotion(q_ref, qd_ref, qdd_ref);  // too late
  }
  for (int k = 0; k < 200; ++k) update();
  EXPECT_LT((hardware.effort() - stopping(q_ref, qd_ref, 1.0)).norm(), kRounding);

  controller.get_node()->deactivate();
  ASSERT_TRUE(activate());
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref)).norm(), kRounding);
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, UnsoundReference,
                         ::testing::Values(std::pair<std::size_t, double>{0, kNan},
                                           std::pair<std::size_t, double>{1, kInfinity},
                                           std::pair<std::size_t, double>{2, kNan},
                                           std::pair<std::size_t, double>{0, 0.91},  // a step
                                           std::pair<std::size_t, double>{0, 4.0},
                                           std::pair<std::size_t, double>{1, -3.2}));

TEST_F(InverseDynamicsControllerTest, LimitsOfReferencesCanBeGiven) {
  Parameters parameters = good();
  parameters["limits.velocity"] = rclcpp::ParameterValue(std::vector<double>{0.25});
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);  // one joint with 0.3 rad/s
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - stopping(q, qd, kPeriod)).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, AStepIsRampedOnRequest) {
  Parameters parameters = good();
  parameters["reference_steps"] = rclcpp::ParameterValue("ramp");
  hardware.set(q, zero);
  ASSERT_TRUE(start(parameters)) << log.text();
  hardware.set(q, qd);
  const Eigen::VectorXd there = q + vec({0.0, 0.3, 0.0, 0.0, 0.0, 0.0});
  setMotion(there, zero, zero);
  EXPECT_EQ(update(), return_type::OK);
  const double v = 2.0 * kPeriod;  // with stop_deceleration
  const Eigen::VectorXd one = vec({0.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_LT((hardware.effort() - expected(q + v * kPeriod * one, v * one, 2.0 * one)).norm(),
            kRounding);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(there, zero, zero)).norm(), kRounding);
  EXPECT_TRUE(spinUntil([this] {
    return log.has(
        "WARN: the reference steps farther than the limits of velocity and "
        "acceleration allow: ramped");
  })) << log.text();
}

// tolerated_fault_time is 0.02 s.
class LastingFault : public InverseDynamicsControllerTest,
                     public ::testing::WithParamInterface<bool> {};

TEST_P(LastingFault, LeavesTheSafeTorqueUntilAFallbackControllerTakesOver) {
  const bool has_fallback = GetParam();
  Parameters parameters = good();
  if (has_fallback) {
    parameters["fallback_controllers"] = rclcpp::ParameterValue(std::vector<std::string>{"other"});
  }
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  hardware.q[3] = kNan;
  const Eigen::VectorXd braked = solver()->getGravityVector(q) - 4.0 * qd;
  int cycles = 0;
  while (update() == return_type::OK && cycles < 100) {
    EXPECT_LT((hardware.effort() - braked).norm(), kRounding);
    ++cycles;
  }
  EXPECT_NEAR(cycles, has_fallback ? 20 : 100, 1);
  hardware.set(q, qd);
  EXPECT_EQ(update(), has_fallback ? return_type::ERROR : return_type::OK);
  EXPECT_LT((hardware.effort() - braked).norm(), kRounding);
  controller.get_node()->deactivate();
  ASSERT_TRUE(activate());
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref)).norm(), kRounding);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutAFallback, LastingFault, ::testing::Bool());

TEST_F(InverseDynamicsControllerTest, AShortFaultIsTolerated) {
  ASSERT_TRUE(start(good())) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  hardware.qd[0] = kNan;
  for (int k = 0; k < 5; ++k) EXPECT_EQ(update(), return_type::OK);
  EXPECT_TRUE(hardware.effort().allFinite());
  hardware.set(q, qd);
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref)).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, GainsChangeWhileItRuns) {
  Parameters parameters = good();
  ASSERT_TRUE(start(parameters)) << log.text();
  setMotion(q_ref, qd_ref, qdd_ref);
  EXPECT_EQ(update(), return_type::OK);
  const std::string name = "gains.natural_frequency";
  EXPECT_EQ(set(name, rclcpp::ParameterValue(std::vector<double>{8.0})), "");
  ASSERT_TRUE(effortChanges()) << log.text();
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref, 8.0)).norm(), kRounding);

  // What doesn't fit is refused with a reason, and changes nothing.
  EXPECT_EQ(set(name, rclcpp::ParameterValue(std::vector<double>{8.0, 9.0})),
            "parameter 'gains.natural_frequency': wrong size: expected 6 numbers, or one for all, "
            "got 2; give one for each of the joints shoulder_pan_joint, shoulder_lift_joint, "
            "elbow_joint, wrist_1_joint, wrist_2_joint, wrist_3_joint");
  EXPECT_NE(set(name, rclcpp::ParameterValue(std::vector<double>{-1.0})), "");
  EXPECT_NE(set(name, rclcpp::ParameterValue(std::vector<double>{1e4})), "");
  EXPECT_NE(set(name, rclcpp::ParameterValue(std::vector<double>{kNan})), "");
  const std::string unstable =
      set("gains.damping_ratio", rclcpp::ParameterValue(std::vector<double>{0.0}));
  EXPECT_NE(unstable.find("unstable in the sampled loop"), std::string::npos) << unstable;
  const auto fails = [this] { return update() != return_type::OK; };
  EXPECT_FALSE(spinUntil(fails, std::chrono::milliseconds(300)));
  EXPECT_LT((hardware.effort() - expected(q_ref, qd_ref, qdd_ref, 8.0)).norm(), kRounding);
}

TEST_F(InverseDynamicsControllerTest, PublishesWhatItDoes) {
  using control_msgs::msg::JointTrajectoryControllerState;
  ASSERT_TRUE(start(good())) << log.text();
  const auto node = std::make_shared<rclcpp::Node>("listener");
  JointTrajectoryControllerState::ConstSharedPtr last;
  const auto subscription = node->create_subscription<JointTrajectoryControllerState>(
      "under_test/controller_state", 10,
      [&last](JointTrajectoryControllerState::ConstSharedPtr state) { last = state; });
  executor.add_node(node);
  setMotion(q_ref, qd_ref, qdd_ref);
  ASSERT_TRUE(spinUntil([&] {
    update();
    return last != nullptr;
  }));
  using Numbers = std::vector<double>;
  const auto numbers = [](const Eigen::VectorXd& v) {
    return Numbers(v.data(), v.data() + v.size());
  };
  EXPECT_EQ(last->joint_names, ur10Joints());
  EXPECT_EQ(last->reference.positions, numbers(q_ref));
  EXPECT_EQ(last->reference.velocities, numbers(qd_ref));
  EXPECT_EQ(last->reference.accelerations, numbers(qdd_ref));
  EXPECT_EQ(last->feedback.positions, numbers(q));
  EXPECT_EQ(last->feedback.velocities, numbers(qd));
  EXPECT_EQ(last->error.positions, numbers(q_ref - q));
  EXPECT_EQ(last->error.velocities, numbers(qd_ref - qd));
  EXPECT_EQ(last->output.effort, hardware.tau);
}

TEST_F(InverseDynamicsControllerTest, DeactivationLeavesNoEffortBehind) {
  ASSERT_TRUE(start(good())) << log.text();
  update();
  ASSERT_GT(hardware.effort().norm(), 1.0);
  controller.get_node()->deactivate();
  EXPECT_EQ(hardware.effort(), zero);
}

}  // namespace
}  // namespace inverse_dynamics_controllers
