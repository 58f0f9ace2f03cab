// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <inverse_dynamics_ros/retime_parameters.hpp>
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

JointTrajectory timed(const JointTrajectory& path, const retime::Params& params = retime::Params(),
                      double slower = 1.0) {
  const Retiming arm = retiming(params);
  return arm.timed(arm.path(path), arm.limits(), slower);
}

std::string refusal(const JointTrajectory& path, const retime::Params& params = retime::Params()) {
  try {
    timed(path, params);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Retiming, TakesTheShortestTimeAndFillsInEfforts) {
  const JointTrajectory found = timed(path(0.5));
  EXPECT_NEAR(duration(found), kFastest, 0.005 * kFastest);
  EXPECT_NEAR(found.points.back().positions[0], 0.5, 1e-9);
  for (const auto& point : found.points) {
    EXPECT_NEAR(point.effort[0], 2.0 * point.accelerations[0] + kWeight, 1e-9);
    EXPECT_LT(std::abs(point.effort[0]), 9.0 * 1.005);
    EXPECT_LT(std::abs(point.velocities[0]), 1.005);
  }
}

TEST(Retiming, AMotionMayBeSlower) {
  EXPECT_NEAR(duration(timed(path(0.5), retime::Params(), 2.0)), 2 * kFastest, 0.01 * kFastest);
}

TEST(Retiming, TakesLimitsInTheOrderOfThePath) {
  const NodeRobot robot(inverse_dynamics_solver::Parameters{{"robot", "ur10_simulated"}});
  const Retiming arm(robot, robot.description(), retime::Params());
  std::vector<std::string> joints = robot.makeSolver(robot.description())->jointNames();
  std::reverse(joints.begin(), joints.end());
  PathLimits given;
  given.torque = {6, 5, 4, 3, 2, 1};
  const auto limits = arm.limits(joints, given);
  for (int j = 0; j < 6; ++j) EXPECT_EQ(limits.torque[j], j + 1);
  EXPECT_EQ(limits.velocity, arm.limits().velocity);
}

TEST(Retiming, RefusesWhatCannotBeTimed) {
  EXPECT_EQ(refusal(path(0.5, "lift")),
            "path: expected the joints slide, got lift; see the parameter 'joints'");
  EXPECT_EQ(refusal(path(1.5)).substr(0, 47), "path: joint slide: expected positions from -1.0");
  retime::Params weak;
  weak.limits.torque = {3.0};
  EXPECT_NE(refusal(path(0.5), weak).find("slide"), std::string::npos);
  weak.limits.torque = {3.0, 4.0};
  EXPECT_EQ(refusal(path(0.5), weak),
            "parameter 'limits.torque': wrong size: expected 1 numbers, or one for all, got 2; "
            "give one for "
            "each of the joints slide");
}

// A node with its client.
class RetimeNodeTest : public testing::Test {
 protected:
  using Retime = inverse_dynamics_msgs::srv::Retime;

  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  Retime::Response answer(const Retime::Request& request) {
    rclcpp::executors::SingleThreadedExecutor executor;
    executor.add_node(node_);
    executor.add_node(user_);
    EXPECT_TRUE(client_->wait_for_service(std::chrono::seconds(10)));
    auto result = client_->async_send_request(std::make_shared<Retime::Request>(request));
    if (executor.spin_until_future_complete(result, std::chrono::seconds(10)) !=
        rclcpp::FutureReturnCode::SUCCESS) {
      return Retime::Response();
    }
    return *result.get();
  }

  static Retime::Request request(double end) {
    Retime::Request request;
    request.path = path(end);
    return request;
  }

 private:
  std::shared_ptr<RetimeNode> node_ =
      std::make_shared<RetimeNode>(rclcpp::NodeOptions().parameter_overrides(
          {{"plugin_name", kSolver}, {"robot_description", kUrdf}, {"ids.gravity", kGravity}}));
  rclcpp::Node::SharedPtr user_ = std::make_shared<rclcpp::Node>("user");
  rclcpp::Client<Retime>::SharedPtr client_ = user_->create_client<Retime>("retime");
};

TEST_F(RetimeNodeTest, AnswersWithTheFastestMotion) {
  const Retime::Response done = answer(request(0.5));
  ASSERT_EQ(done.error_code, Retime::Response::SUCCESSFUL) << done.message;
  EXPECT_EQ(done.message, "");
  EXPECT_TRUE(done.ignored.empty());
  EXPECT_EQ(done.trajectory.header.frame_id, "base");
  EXPECT_NEAR(duration(done.trajectory), kFastest, 0.005 * kFastest);
}

TEST_F(RetimeNodeTest, TakesWhatTheRequestSays) {
  Retime::Request wanted = request(0.5);
  wanted.path.points.insert(wanted.path.points.begin() + 1, wanted.path.points[0]);
  wanted.path.points[1].positions = {0.25};
  EXPECT_NEAR(duration(answer(wanted).trajectory), kFastest, 0.005 * kFastest);
  // 0.25 m are too short for 1 m/s: up with (9 - 4) / 2 m/s^2, to rest with (9 + 4) / 2 m/s^2, twice
  const double stopping = 2 * std::sqrt(2 * 0.25 * (1 / 2.5 + 1 / 6.5));
  wanted.stops = {1};
  EXPECT_NEAR(duration(answer(wanted).trajectory), stopping, 0.005 * stopping);
  wanted.stops.clear();
  wanted.shape = Retime::Request::LINES;  // a line goes on straight
  wanted.velocity_scaling_factor = 0.5;
  EXPECT_NEAR(duration(answer(wanted).trajectory), 2 * kFastest, 0.01 * kFastest);
  // up with (20 - 4) / 2 m/s^2 to 0.5 m/s, and to rest with (20 + 4) / 2 m/s^2
  wanted.velocity_scaling_factor = 1.0;
  wanted.torque_limits = {20.0};
  wanted.velocity_limits = {0.5};
  const double limited = 0.5 / 8 + (0.5 - 0.125 / 8 - 0.125 / 12) / 0.5 + 0.5 / 12;
  EXPECT_NEAR(duration(answer(wanted).trajectory), limited, 0.005 * limited);
  EXPECT_NEAR(duration(answer(request(0.5)).trajectory), kFastest, 0.005 * kFastest);
}

TEST_F(RetimeNodeTest, NamesWhatOfThePathIsNotUsed) {
  Retime::Request wanted = request(0.5);
  wanted.path.points[0].velocities = {0.0};
  wanted.path.points[1].time_from_start.sec = 3;
  EXPECT_EQ(answer(wanted).ignored, (std::vector<std::string>{"velocities", "time_from_start"}));
}

TEST_F(RetimeNodeTest, CarriesThePayloadOfOneRequest) {
  Retime::Request loaded = request(0.5);
  loaded.payload.header.frame_id = "cart";
  loaded.payload.inertia.m = 1.0;  // 3 kg, 6 N
  const auto accelerated = answer(loaded).trajectory;
  ASSERT_FALSE(accelerated.points.empty());
  for (const auto& point : accelerated.points)
    EXPECT_NEAR(point.effort[0], 3.0 * point.accelerations[0] + 6.0, 1e-9);
  EXPECT_NEAR(duration(answer(request(0.5)).trajectory), kFastest, 0.005 * kFastest);
}

TEST_F(RetimeNodeTest, SaysWhyThereIsNoMotion) {
  const Retime::Response refused = answer(request(1.5));
  EXPECT_EQ(refused.error_code, Retime::Response::INVALID_PATH);
  EXPECT_EQ(refused.message.substr(0, 47), "path: joint slide: expected positions from -1.0");
  EXPECT_TRUE(refused.trajectory.points.empty());
  const auto expectRefused = [&](std::int32_t code, const std::string& text, const auto& change) {
    Retime::Request wrong = request(0.5);
    change(wrong);
    const Retime::Response response = answer(wrong);
    EXPECT_EQ(response.error_code, code) << response.message;
    EXPECT_NE(response.message.find(text), std::string::npos) << response.message;
  };
  using Codes = Retime::Response;
  for (const double factor : {0.0, 1.5, std::nan("")}) {
    expectRefused(Codes::INVALID_REQUEST, "velocity_scaling_factor: expected a number above 0",
                  [&](auto& wrong) { wrong.velocity_scaling_factor = factor; });
  }
  expectRefused(Codes::INVALID_REQUEST, "shape: expected", [](auto& wrong) { wrong.shape = 7; });
  expectRefused(Codes::INVALID_REQUEST, "shape: expected", [](auto& wrong) {
    wrong.shape = Retime::Request::LINES;
    wrong.deviation = -0.1;
  });
  expectRefused(Codes::INVALID_REQUEST, "torque_limits", [](auto& wrong) {
    wrong.torque_limits = {1.0, 2.0};
  });
  expectRefused(Codes::INVALID_REQUEST, "velocity_limits: expected numbers above 0",
                [](auto& wrong) { wrong.velocity_limits = {-1.0}; });
  expectRefused(Codes::INVALID_REQUEST, "cart",
                [](auto& wrong) { wrong.payload.header.frame_id = "tool0"; });
  expectRefused(Codes::INVALID_PATH, "7", [](auto& wrong) { wrong.stops = {7}; });
  expectRefused(Codes::INFEASIBLE, "slide", [](auto& wrong) { wrong.payload.inertia.m = 10.0; });
}

}  // namespace
}  // namespace inverse_dynamics_ros
