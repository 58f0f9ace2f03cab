// SPDX-License-Identifier: Apache-2.0
#include "reference_topic.hpp"

#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"
#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

using trajectory_msgs::msg::JointTrajectory;
using Numbers = std::vector<double>;

const std::vector<std::string> kJoints = {"a", "b"};

JointTrajectory message() {
  JointTrajectory trajectory;
  trajectory.joint_names = {"b", "a"};
  trajectory.points.resize(1);
  trajectory.points[0].positions = {1, 2};
  trajectory.points[0].velocities = {3, 4};
  return trajectory;
}

const ReferenceLayout& motion() {
  static const ReferenceLayout layout({"position", "velocity", "acceleration"}, kJoints);
  return layout;
}

TEST(ReferencesOf, JointsAreFoundByName) {
  Numbers values(6, kNan);
  EXPECT_EQ(referencesOf(message(), motion(), kJoints, values), "");
  EXPECT_EQ(values, (Numbers{2, 4, 0, 1, 3, 0}));
}

TEST(ReferencesOf, WhatDoesNotFitIsSaid) {
  const auto errorOf = [](const JointTrajectory& bad, const ReferenceLayout& layout = motion()) {
    Numbers values(layout.size(), 7.0);
    const std::string error = referencesOf(bad, layout, kJoints, values);
    EXPECT_EQ(values, Numbers(layout.size(), 7.0));
    return error;
  };
  JointTrajectory bad = message();
  bad.joint_names = {"a", "c"};
  EXPECT_EQ(errorOf(bad), "joint_names: 'b' is missing: expected a, b, got a, c");
  bad.joint_names = {"a", "b", "c"};
  EXPECT_EQ(errorOf(bad), "joint_names: expected 2 (a, b), got 3 (a, b, c)");
  bad = message();
  bad.points.resize(2);
  EXPECT_EQ(errorOf(bad),
            "points: expected 1, the reference from now on, got 2; for whole trajectories put a "
            "joint_trajectory_controller before this one");
  bad = message();
  bad.points[0].velocities.clear();
  EXPECT_EQ(errorOf(bad),
            "points[0].velocities: expected 2 numbers, one for each of joint_names, got 0");
  bad = message();
  bad.points[0].accelerations = {1};
  EXPECT_EQ(errorOf(bad),
            "points[0].accelerations: expected 2 numbers, one for each of joint_names, got 1");
  EXPECT_EQ(errorOf(message(), ReferenceLayout({"effort"}, kJoints)),
            "points[0].effort: expected 2 numbers, one for each of joint_names, got 0");
}

class ReferenceTopicTest : public ControllerFixture<InverseDynamicsController> {
 protected:
  void SetUp() override {
    Parameters parameters = good();
    parameters["gains.natural_frequency"] = rclcpp::ParameterValue(Numbers{5.0});
    ASSERT_TRUE(configure(parameters)) << log.text();
    interfaces_ = controller.export_reference_interfaces();
    executor.add_node(sender_);
    publisher_ = sender_->create_publisher<JointTrajectory>("under_test/reference", 1);
    ASSERT_TRUE(spinUntil([this] { return publisher_->get_subscription_count() == 1; }));
    ASSERT_TRUE(activate());
  }

  JointTrajectory moving() const {
    JointTrajectory trajectory;
    trajectory.joint_names = ur10Joints();
    trajectory.points.resize(1);
    trajectory.points[0].positions = Numbers(6, 0.0);
    trajectory.points[0].velocities = Numbers(6, 0.1);
    return trajectory;
  }

  rclcpp::Node::SharedPtr sender_ = std::make_shared<rclcpp::Node>("sender");
  rclcpp::Publisher<JointTrajectory>::SharedPtr publisher_;
  decltype(controller.export_reference_interfaces()) interfaces_;
};

TEST_F(ReferenceTopicTest, AMessageIsFollowedUntilItIsStale) {
  update();
  publisher_->publish(moving());
  ASSERT_TRUE(effortChanges());
  const Eigen::VectorXd following = hardware.effort();
  for (int k = 0; k < 150; ++k) update();
  EXPECT_EQ(hardware.effort(), following);
  for (int k = 0; k < 150; ++k) update();  // beyond reference_timeout, 0.2 s
  EXPECT_NE(hardware.effort(), following);
  EXPECT_TRUE(spinUntil([this] {
    return log.has("ERROR: no new reference came while the last one still moves: stopping");
  })) << log.text();
}

class StampedReference : public ReferenceTopicTest, public ::testing::WithParamInterface<int> {};

TEST_P(StampedReference, OfAnotherTimeIsReportedAndIgnored) {
  update();
  const Eigen::VectorXd holding = hardware.effort();
  JointTrajectory message = moving();
  message.header.stamp = sender_->now() - rclcpp::Duration(GetParam(), 0);
  EXPECT_TRUE(spinUntil([&] {  // said once a second, whichever message it was
    publisher_->publish(message);
    return log.has("ERROR: ~/reference: ignored: header.stamp: expected now, or zero, got ");
  })) << log.text();
  update();
  EXPECT_EQ(hardware.effort(), holding);
}

INSTANTIATE_TEST_SUITE_P(LateAndEarly, StampedReference, ::testing::Values(3600, -3600));

TEST_F(ReferenceTopicTest, AStepOfOneMessageIsRefused) {
  update();
  const Eigen::VectorXd holding = hardware.effort();
  JointTrajectory far = moving();
  far.points[0].positions[0] = 3.0;
  publisher_->publish(far);
  EXPECT_TRUE(spinUntil([this] {
    update();
    return log.has(
        "ERROR: the reference steps farther than the limits of velocity and acceleration allow "
        "(shoulder_pan_joint): stopping");
  })) << log.text();
  EXPECT_EQ(hardware.effort(), holding);
}

TEST_F(ReferenceTopicTest, AMessageThatDoesNotFitIsReportedAndIgnored) {
  update();
  const Eigen::VectorXd holding = hardware.effort();
  JointTrajectory bad = moving();
  bad.joint_names[2] = "elbow";
  publisher_->publish(bad);
  EXPECT_TRUE(spinUntil([this] {
    return log.has("ERROR: ~/reference: ignored: joint_names: 'elbow_joint' is missing");
  })) << log.text();
  update();
  EXPECT_EQ(hardware.effort(), holding);
}

}  // namespace
}  // namespace inverse_dynamics_controllers
