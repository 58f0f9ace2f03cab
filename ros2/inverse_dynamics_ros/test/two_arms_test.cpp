// SPDX-License-Identifier: Apache-2.0
//
// Two nodes in namespaces of their own, each for one arm.
#include <gtest/gtest.h>
#include <rclcpp/version.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <string>
#include <thread>
#include <vector>

#include "inverse_dynamics_ros/live_node.hpp"

namespace inverse_dynamics_ros {
namespace {

using sensor_msgs::msg::JointState;

constexpr double kGravity = 9.81;  // m/s^2
constexpr double kLength = 0.5;    // m
constexpr double kAngle = 0.5;     // rad

// Hangs down at 0.
std::string pendulum(double mass) {
  return "<robot name='pendulum'><link name='base'/><link name='rod'><inertial><origin xyz='0 0 "
         "-0.5'/>"
         "<mass value='" +
         std::to_string(mass) +
         "'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
         "<joint name='swing' type='revolute'><parent link='base'/><child link='rod'/>"
         "<axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='100' "
         "velocity='9'/></joint></robot>";
}

/// A live node in a namespace, and what it is told and tells.
struct Arm {
  Arm(const std::string& side, double mass, const std::string& more = "cutoff",
      double value = 20.0) {
    rclcpp::NodeOptions options;
    options.arguments({"--ros-args", "-r", "__ns:=/" + side});
    options.parameter_overrides(
        {{"plugin_name", "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"},
         {"robot_description", pendulum(mass)},
         {more, value}});
    node = std::make_shared<LiveNode>(options);
    tester = std::make_shared<rclcpp::Node>("tester", side);
    states = tester->create_publisher<JointState>("joint_states", 10);
    subscription = tester->create_subscription<JointState>(
        "live/torques", 10,
        [this](const JointState& message) { torques.push_back(message.effort.at(0)); });
  }

  void addTo(rclcpp::Executor& executor) const {
    executor.add_node(node);
    executor.add_node(tester);
  }

  void rest(int sample) {
    JointState state;
    state.header.stamp = rclcpp::Time(1'000'000'000 + 10'000'000L * sample);
    state.name = {"swing"};
    state.position = {kAngle};
    state.velocity = {0.0};
    states->publish(state);
  }

  std::vector<double> torques;
  std::shared_ptr<LiveNode> node;
  rclcpp::Node::SharedPtr tester;
  rclcpp::Publisher<JointState>::SharedPtr states;
  rclcpp::Subscription<JointState>::SharedPtr subscription;
};

class TwoArms : public testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
};

TEST_F(TwoArms, EachNodeServesItsOwn) {
  Arm left("left", 2.0), right("right", 4.0);
  rclcpp::executors::SingleThreadedExecutor executor;
  left.addTo(executor);
  right.addTo(executor);
  for (Arm* arm : {&left, &right}) {
    EXPECT_TRUE(arm->torques.empty());
    for (int k = 0; k < 1000 && arm->torques.empty(); ++k) {
      arm->rest(k);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      executor.spin_some();
    }
    ASSERT_FALSE(arm->torques.empty());
  }
  EXPECT_NEAR(left.torques.back(), 2.0 * kGravity * kLength * std::sin(kAngle), 1e-6);
  EXPECT_NEAR(right.torques.back(), 4.0 * kGravity * kLength * std::sin(kAngle), 1e-6);
}

TEST_F(TwoArms, AMisspeltParameterIsRefused) {
  try {
    const Arm arm("left", 2.0, "payload.mas", 1.0);
    ADD_FAILURE() << "no exception";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'payload.mass'?"), std::string::npos)
        << error.what();
  }
}

TEST_F(TwoArms, AMisspeltParameterIsRefusedByTheParameterService) {
  const Arm arm("left", 2.0);
  rclcpp::executors::SingleThreadedExecutor executor;
  arm.addTo(executor);
  rclcpp::AsyncParametersClient client(arm.tester, "live");
  ASSERT_TRUE(client.wait_for_service(std::chrono::seconds(10)));
  auto results = client.set_parameters({rclcpp::Parameter("payload.mas", 1.0)});
  executor.spin_until_future_complete(results, std::chrono::seconds(10));
  const auto result = results.get().at(0);
  EXPECT_FALSE(result.successful);
#if RCLCPP_VERSION_GTE(17, 0, 0)  // humble's service answers in words of its own
  EXPECT_NE(result.reason.find("did you mean 'payload.mass'?"), std::string::npos) << result.reason;
#endif
}

}  // namespace
}  // namespace inverse_dynamics_ros
