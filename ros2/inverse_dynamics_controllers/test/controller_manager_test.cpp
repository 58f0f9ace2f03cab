// SPDX-License-Identifier: Apache-2.0
//
// What a controller manager loads; two arms under one manager, and under two in namespaces, each with controllers
// of its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <control_msgs/msg/joint_trajectory_controller_state.hpp>
#include <controller_manager/controller_manager.hpp>
#include <controller_manager_msgs/srv/switch_controller.hpp>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <rclcpp/executors/single_threaded_executor.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace inverse_dynamics_controllers {
namespace {

using control_msgs::msg::JointTrajectoryControllerState;
using controller_interface::return_type;
using sensor_msgs::msg::JointState;

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
         "name='initial_value'>0</param></state_interface><state_interface name='effort'><param "
         "name='initial_value'>0</param></state_interface></joint>";
}

std::string robot(const std::string& arms, const std::string& interfaces) {
  return "<robot name='arms'><link name='base'/>" + arms +
         "<ros2_control name='arms' type='system'><hardware><plugin>mock_components/GenericSystem"
         "</plugin></hardware>" +
         interfaces + "</ros2_control></robot>";
}

// The effort that carries a pendulum.
double weight(double mass, double angle) { return mass * kGravity * kLength * std::sin(angle); }

constexpr const char* kDamping = "    damping: {values: [1.0]}\n";
const char* const kBoth = "both";  // arms, by one controller

class TwoArms : public testing::Test {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  void SetUp() override {
    add(robot(pendulum("left", 2.0) + pendulum("right", 4.0),
              hardware("left", 0.5) + hardware("right", -1.0)));
    executor_->add_node(listener_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  static std::string type(const std::string& controller) {
    return "inverse_dynamics_controllers/" + controller;
  }

  // Humble's takes the resources, later ones the robot's description.
  template <class Executor>
  static std::shared_ptr<controller_manager::ControllerManager> managerOf(
      const std::shared_ptr<Executor>& executor, const std::string& robot,
      const std::string& name_space) {
    using Manager = controller_manager::ControllerManager;
    using Resources = hardware_interface::ResourceManager;
    if constexpr (std::is_constructible_v<Manager, std::shared_ptr<Executor>, std::string, bool,
                                          std::string, std::string>) {
      return std::make_shared<Manager>(executor, robot, true, "manager", name_space);
    } else {
      return std::make_shared<Manager>(std::make_unique<Resources>(robot), executor, "manager",
                                       name_space);
    }
  }

  // Another controller manager, which is meant from now on.
  void add(const std::string& robot, const std::string& name_space = "") {
    manager_ = managerOf(executor_, robot, name_space);
    managers_.push_back(manager_);
    executor_->add_node(manager_);
  }

  // Loads a controller with parameters of its own.
  return_type configure(const std::string& arm, const std::string& more = kDamping,
                        const std::string& name = "",
                        const std::string& controller = "GravityCompensationController") {
    std::ofstream(file_)
        << "/**/" << arm << name << ":\n  ros__parameters:\n"
        << (arm == kBoth ? "    plugin_name: rigid_body_inverse_dynamics_solver/"
                           "InverseDynamicsSolverRigidBody\n"
                         : "    plugin_name: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL\n"
                           "    ids: {root: base, tip: " +
                               arm + "_rod}\n")
        << more;
    manager_->set_parameter({arm + name + ".params_file", file_.string()});
    if (!manager_->load_controller(arm + name, type(controller))) return return_type::ERROR;
    return manager_->configure_controller(arm + name);
  }

  // One cycle of the control loop. Without callbacks: while controllers are switched, the manager's
  // diagnostics would wait for the switch, and the switch for the next cycle.
  void cycle() {
    for (const auto& manager : managers_) {
      const rclcpp::Time now = manager->get_clock()->now();
      const auto period = rclcpp::Duration::from_seconds(0.01);
      manager->read(now, period);
      manager->update(now, period);
      manager->write(now, period);
    }
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

  // Whether a topic says this number, at last.
  template <class Message>
  void expect(double number, const std::string& topic, double (*said)(const Message&)) {
    double last = NAN;
    const auto subscription = listener_->create_subscription<Message>(
        topic, 1, [&](const Message& message) { last = said(message); });
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!(std::abs(last - number) < 1e-4) && std::chrono::steady_clock::now() < end) {
      cycle();
      executor_->spin_some();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_NEAR(last, number, 1e-4) << topic;
  }
  template <std::size_t Joint = 0>
  void expectEffort(double effort, const std::string& controller) {
    expect<JointTrajectoryControllerState>(
        effort, controller + "/controller_state",
        [](const JointTrajectoryControllerState& state) { return state.output.effort.at(Joint); });
  }
  void expectExternal(double torque, const std::string& broadcaster) {
    expect<JointState>(torque, broadcaster + "/external_torques",
                       [](const JointState& state) { return state.effort.at(0); });
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("two_arms_" + std::to_string(::getpid()) + ".yaml");
  const std::shared_ptr<rclcpp::Executor> executor_ =
      std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  const std::shared_ptr<rclcpp::Node> listener_ = std::make_shared<rclcpp::Node>("listener");
  std::vector<std::shared_ptr<controller_manager::ControllerManager>> managers_;
  std::shared_ptr<controller_manager::ControllerManager> manager_;  // the last
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
  expectEffort(weight(2.0, 0.5), "/left");
  expectEffort(weight(4.0, -1.0), "/right");
}

class BothArms : public TwoArms, public testing::WithParamInterface<const char*> {};

TEST_P(BothArms, OneControllerServesThemWithOneSolver) {
  ASSERT_EQ(
      configure(kBoth, std::string(kDamping) + "    ids: {root: base, tip: " + GetParam() + "}\n"),
      return_type::OK);
  ASSERT_EQ(activate({kBoth}), return_type::OK);
  expectEffort(weight(2.0, 0.5), "/both");
  expectEffort<1>(weight(4.0, -1.0), "/both");
}

INSTANTIATE_TEST_SUITE_P(Tips, BothArms,
                         testing::Values("'left_rod,right_rod'", "[left_rod, right_rod]", "'*'"));

// Joints and controllers have the same names in both. Broadcasters expect a load that isn't there.
TEST_F(TwoArms, ControllersAndBroadcastersOfANamespaceServeItsOwn) {
  for (const auto& [side, mass] : {std::pair("left", 3.0), {"right", 5.0}}) {
    add(robot(pendulum("arm", mass), hardware("arm", 0.5)), side);
    ASSERT_EQ(configure("arm"), return_type::OK);
    const std::string load =
        "    payload: {mass: " + std::to_string(mass) + ", center_of_mass: [0.0, 0.0, -0.5]}\n";
    // The manager measures its periods: a busy computer's are long.
    const std::string sensing = "    noise: [1.0]\n    longest_period: 10.0\n";
    ASSERT_EQ(configure("arm", sensing + load, "_touch", "ExternalWrenchBroadcaster"),
              return_type::OK);
    ASSERT_EQ(activate({"arm", "arm_touch"}), return_type::OK);
  }
  expectEffort(weight(3.0, 0.5), "/left/arm");
  expectEffort(weight(5.0, 0.5), "/right/arm");
  expectExternal(-weight(3.0, 0.5), "/left/arm_touch");
  expectExternal(-weight(5.0, 0.5), "/right/arm_touch");
}

// The manager's period is 0.01 s. 120 rad/s is unstable there, and stable at 500 Hz.
TEST_F(TwoArms, GainsAreCheckedAgainstTheManagersPeriod) {
  const auto configured = [this](const std::string& name, const std::string& more) {
    return configure("left", kDamping + more, name, "InverseDynamicsController");
  };
  const std::string fast = "    gains: {natural_frequency: [120.0]}\n";
  EXPECT_EQ(configured("_a", fast), return_type::ERROR);
  EXPECT_EQ(configured("_b", fast + "    period: 0.0\n"), return_type::ERROR);
  EXPECT_EQ(configured("_c", fast + "    period: 0.002\n"), return_type::ERROR);
  EXPECT_EQ(configured("_d", "    gains: {natural_frequency: [60.0]}\n"), return_type::OK);
}

TEST_F(TwoArms, AMisspeltLimitIsRefusedByTheManager) {
  EXPECT_EQ(configure("left", std::string(kDamping) + "    limits: {effrot: [1.0]}\n"),
            return_type::ERROR);
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
