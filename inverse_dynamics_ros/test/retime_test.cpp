// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "retime_node.hpp"

namespace inverse_dynamics_ros {
namespace {

using trajectory_msgs::msg::JointTrajectory;

constexpr const char* kSolver = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";
// A cart of 2 kg on a vertical slide: 9 N, 1 m/s.
constexpr const char* kUrdf = R"(<robot name="arm">
  <link name="base"/>
  <link name="cart"><inertial><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
</robot>
)";
const std::vector<double> kGravity = {0.0, 0.0, -2.0};  // m/s^2
constexpr double kWeight = 4.0;                         // N
// Up by 0.5 m with (9 - 4) / 2 m/s^2 to 1 m/s, and to rest with (9 + 4) / 2 m/s^2.
constexpr double kFastest = 1 / 2.5 + (0.5 - 0.5 / 2.5 - 0.5 / 6.5) + 1 / 6.5;  // s

JointTrajectory path(double end, const std::string& joint = "slide") {
  JointTrajectory path;
  path.header.frame_id = "base";
  path.joint_names = {joint};
  path.points.resize(2);
  path.points[0].positions = {0.0};
  path.points[1].positions = {end};
  return path;
}

double duration(const JointTrajectory& timed) {
  return rclcpp::Duration(timed.points.back().time_from_start).seconds();
}

Retiming retiming(const retime::Params& params = retime::Params()) {
  const NodeRobot robot({{"plugin_name", kSolver}, {"ids.gravity", kGravity}});
  return Retiming(robot, kUrdf, params);
}

std::string refusal(const JointTrajectory& path, const retime::Params& params = retime::Params()) {
  try {
    retiming(params).timed(path);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Retiming, TakesTheShortestTimeAndFillsInEfforts) {
  const JointTrajectory timed = retiming().timed(path(0.5));
  EXPECT_NEAR(duration(timed), kFastest, 0.005 * kFastest);
  EXPECT_NEAR(timed.points.back().positions[0], 0.5, 1e-9);
  EXPECT_EQ(timed.header.frame_id, "base");
  for (const auto& point : timed.points) {
    EXPECT_NEAR(point.effort[0], 2.0 * point.accelerations[0] + kWeight, 1e-9);
    EXPECT_LT(std::abs(point.effort[0]), 9.0 * 1.005);
    EXPECT_LT(std::abs(point.velocities[0]), 1.005);
  }
}

TEST(Retiming, AMotionMayBeSlower) {
  EXPECT_NEAR(duration(retiming().timed(path(0.5), 2.0)), 2 * kFastest, 0.01 * kFastest);
}

TEST(Retiming, RefusesWhatCannotBeTimed) {
  EXPECT_EQ(refusal(path(0.5, "lift")),
            "path: expected the joints slide, got lift; see the parameter 'joints'");
  EXPECT_EQ(refusal(path(1.5)).substr(0, 47), "path: joint slide: expected positions from -1.0");
  retime::Params weak;
  weak.limits.torque = {3.0};
  EXPECT_NE(refusal(path(0.5), weak).find("slide"), std::string::npos);
  weak.limits.torque = {3.0, 4.0};
  EXPECT_EQ(
      refusal(path(0.5), weak),
      "parameter 'limits.torque': expected 1 numbers, or one for all joints, got 2; give one for "
      "each joint");
}

TEST(RetimeNode, AnswersEachPathOnce) {
  rclcpp::init(0, nullptr);
  {
    const auto node = std::make_shared<RetimeNode>(rclcpp::NodeOptions().parameter_overrides(
        {{"plugin_name", kSolver}, {"robot_description", kUrdf}, {"ids.gravity", kGravity}}));
    const auto tester = std::make_shared<rclcpp::Node>("tester");
    std::vector<JointTrajectory> answers;
    const auto subscription = tester->create_subscription<JointTrajectory>(
        "retime/trajectory", 10, [&](const JointTrajectory& answer) { answers.push_back(answer); });
    const auto publisher = tester->create_publisher<JointTrajectory>("retime/path", 10);
    rclcpp::executors::SingleThreadedExecutor executor;
    executor.add_node(node);
    executor.add_node(tester);
    const auto until = [&](const auto& condition) {
      for (int k = 0; k < 1000 && !condition(); ++k)
        executor.spin_once(std::chrono::milliseconds(10));
      return condition();
    };
    ASSERT_TRUE(until([&] {
      return publisher->get_subscription_count() > 0 && subscription->get_publisher_count() > 0;
    }));
    publisher->publish(path(0.5));
    publisher->publish(path(1.5));  // out of range
    ASSERT_TRUE(until([&] { return answers.size() == 2; }));
    EXPECT_NEAR(duration(answers[0]), kFastest, 0.005 * kFastest);
    EXPECT_EQ(answers[1].points.size(), 0u);
    EXPECT_EQ(answers[1].header.frame_id, "base");
  }
  rclcpp::shutdown();
}

}  // namespace
}  // namespace inverse_dynamics_ros
