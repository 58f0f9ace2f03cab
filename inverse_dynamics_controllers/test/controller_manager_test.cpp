// SPDX-License-Identifier: Apache-2.0
//
// What a controller manager loads, and two arms of one robot under it, each with a controller of its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <control_msgs/msg/joint_trajectory_controller_state.hpp>
#include <controller_manager/controller_manager.hpp>
#include <controller_manager_msgs/srv/switch_controller.hpp>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <rclcpp/executors/single_threaded_executor.hpp>
#include <string>
#include <thread>
#include <vector>

namespace inverse_dynamics_controllers {
namespace {

using control_msgs::msg::JointTrajectoryControllerState;
using controller_interface::return_type;

constexpr double kGravity = 9.81;  // m/s^2
constexpr double kLength = 0.5;    // m

// A pendulum that hangs down at 0, deflected by `angle`.
std::string pendulum(const std::string& side, double mass) {
  return "<link name='" + side + "_rod'><inertial><origin xyz='0 0 -0.5'/><mass value='" +
         std::to_string(mass) +
         "'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
         "<joint name='" +
         side + "_swing' type='revolute'><parent link='base'/><child link='" + side +
         "_rod'/><axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='100' "
         "velocity='9'/></joint>";
}

std::string hardware(const std::string& side, double angle) {
  return "<joint name='" + side +
         "_swing'><command_interface name='effort'/><state_interface name='position'>"
         "<param name='initial_value'>" +
         std::to_string(angle) +
         "</param></state_interface><state_interface name='velocity'><param "
         "name='initial_value'>0</param></state_interface></joint>";
}

std::string robot() {
  return "<robot name='two'><link name='base'/>" + pendulum("left", 2.0) + pendulum("right", 4.0) +
         "<ros2_control name='arms' type='system'><hardware><plugin>mock_components/GenericSystem"
         "</plugin></hardware>" +
         hardware("left", 0.5) + hardware("right", -1.0) + "</ros2_control></robot>";
}

class TwoArms : public testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  void SetUp() override {
    executor_->add_node(manager_);
    executor_->add_node(listener_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  static std::string type(const std::string& controller) {
    return "inverse_dynamics_controllers/" + controller;
  }

  // Loads a controller with parameters of its own.
  return_type configure(const std::string& side, const std::string& more = "") {
    std::ofstream(file_)
        << "/**/" << side << ":\n  ros__parameters:\n"
        << "    plugin_name: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL\n"
        << "    ids: {root: base, tip: " << side << "_rod}\n"
        << "    damping: {values: [1.0]}\n"
        << more;
    manager_->set_parameter({side + ".params_file", file_.string()});
    if (!manager_->load_controller(side, type("GravityCompensationController"))) {
      return return_type::ERROR;
    }
    return manager_->configure_controller(side);
  }

  // One cycle of the control loop.
  void cycle() {
    const rclcpp::Time now = manager_->get_clock()->now();
    const auto period = rclcpp::Duration::from_seconds(0.01);
    manager_->read(now, period);
    manager_->update(now, period);
    manager_->write(now, period);
    executor_->spin_some();
  }

  // Activates controllers while cycles go on.
  return_type activate(const std::vector<std::string>& controllers) {
    auto done = std::async(std::launch::async, [&] {
      return manager_->switch_controller(
          controllers, {}, controller_manager_msgs::srv::SwitchController::Request::STRICT);
    });
    while (done.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) cycle();
    return done.get();
  }

  // The effort that a controller says it commands, of its first joint; NaN: it says nothing.
  double effort(const std::string& side) {
    double effort = NAN;
    const auto subscription = listener_->create_subscription<JointTrajectoryControllerState>(
        "/" + side + "/controller_state", 1,
        [&](const JointTrajectoryControllerState& state) { effort = state.output.effort.at(0); });
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::isnan(effort) && std::chrono::steady_clock::now() < end) {
      cycle();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return effort;
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("two_arms_" + std::to_string(::getpid()) + ".yaml");
  const std::shared_ptr<rclcpp::Executor> executor_ =
      std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  const std::shared_ptr<rclcpp::Node> listener_ = std::make_shared<rclcpp::Node>("listener");
  const std::shared_ptr<controller_manager::ControllerManager> manager_ =
      std::make_shared<controller_manager::ControllerManager>(executor_, robot(), true, "manager");
};

class Load : public TwoArms, public testing::WithParamInterface<const char*> {};

TEST_P(Load, AControllerManagerFindsIt) {
  EXPECT_NE(manager_->load_controller("under_test", type(GetParam())), nullptr);
}

INSTANTIATE_TEST_SUITE_P(Controllers, Load,
                         testing::Values("ExternalWrenchBroadcaster", "FeedForwardController",
                                         "GravityCompensationController",
                                         "InverseDynamicsController",
                                         "PdGravityCompensationController"));

TEST_F(TwoArms, EachControllerServesItsOwn) {
  ASSERT_EQ(configure("left"), return_type::OK);
  ASSERT_EQ(configure("right"), return_type::OK);
  ASSERT_EQ(activate({"left", "right"}), return_type::OK);
  EXPECT_NEAR(effort("left"), 2.0 * kGravity * kLength * std::sin(0.5), 1e-6);
  EXPECT_NEAR(effort("right"), 4.0 * kGravity * kLength * std::sin(-1.0), 1e-6);
}

TEST_F(TwoArms, AMisspeltLimitIsRefusedByTheManager) {
  EXPECT_EQ(configure("left", "    limits: {effrot: [1.0]}\n"), return_type::ERROR);
}

TEST_F(TwoArms, AMisspeltLimitIsRefusedByTheParameterService) {
  ASSERT_EQ(configure("left"), return_type::OK);
  rclcpp::AsyncParametersClient client(listener_, "left");
  ASSERT_TRUE(client.wait_for_service(std::chrono::seconds(10)));
  auto results = client.set_parameters({rclcpp::Parameter("limits.effrot", std::vector{1.0})});
  executor_->spin_until_future_complete(results, std::chrono::seconds(10));
  const auto result = results.get().at(0);
  EXPECT_FALSE(result.successful);
  EXPECT_NE(result.reason.find("did you mean 'limits.effort'?"), std::string::npos)
      << result.reason;
}

}  // namespace
}  // namespace inverse_dynamics_controllers
