// SPDX-License-Identifier: Apache-2.0
/// @file
/// How hard arms in MuJoCo accelerate when something goes wrong under a controller manager, with the
/// parameters of config/. The arms have no brakes: the efforts that are commanded last act on.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <controller_manager/controller_manager.hpp>
#include <controller_manager_msgs/srv/switch_controller.hpp>
#include <fstream>
#include <future>
#include <hardware_interface/component_parser.hpp>
#include <hardware_interface/system_interface.hpp>
#include <hardware_interface/types/lifecycle_state_names.hpp>
#include <inverse_dynamics_solver/installed_package.hpp>
#include <iostream>
#include <lifecycle_msgs/msg/state.hpp>
#include <limits>
#include <memory>
#include <rclcpp/parameter_map.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mujoco_arm.hpp"

namespace inverse_dynamics_simulation {
namespace {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

constexpr int kRate = 500;               // Hz
constexpr double kPeriod = 1.0 / kRate;  // s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const char* const kFollower = "inverse_dynamics_controller";
const char* const kFallback = "gravity_compensation_controller";

struct Robot {
  friend std::ostream& operator<<(std::ostream& out, const Robot& robot) {
    return out << robot.name;
  }

  std::string name;
  std::vector<std::string> joints;
  std::vector<double> q;  // rad
};

Robot ur10() {
  return {"ur10",
          {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint",
           "wrist_2_joint", "wrist_3_joint"},
          {0.0, -1.6, 1.2, -1.0, -1.5, 0.3}};
}

Robot panda() {
  Robot robot{"panda", {}, {0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8}};
  for (int j = 1; j <= 7; ++j) robot.joints.push_back("fer_joint" + std::to_string(j));
  return robot;
}

std::string urdfOf(const Robot& robot) {
  std::ifstream file(inverse_dynamics_solver::installedPackageShare("inverse_dynamics_robots") +
                     "/urdf/" + robot.name + ".urdf");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string configOf(const Robot& robot) {
  return inverse_dynamics_solver::installedPackageShare("inverse_dynamics_simulation") +
         "/config/" + robot.name + ".yaml";
}

// The arm, what its hardware component tells of it, and its accelerations.
struct Bench {
  Bench(const Robot& robot, const std::string& urdf)
      : arm(urdf, robot.joints, {}), q(robot.q), qd(q.size(), 0.0), tau(q.size(), 0.0) {
    arm.setPosition(
        Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
  }

  void read() {
    for (std::size_t j = 0; j < q.size(); ++j) {
      const bool lost = j < lost_joints;
      q[j] = lost ? kNan : arm.q()[static_cast<Eigen::Index>(j)];
      qd[j] = lost ? kNan : arm.qd()[static_cast<Eigen::Index>(j)];
    }
  }

  void step() {
    const Eigen::VectorXd before = arm.qd();
    arm.step(Eigen::Map<const Eigen::VectorXd>(tau.data(), before.size()), kPeriod);
    greatest = std::max(greatest, (arm.qd() - before).cwiseAbs().maxCoeff() / kPeriod);
  }

  MujocoArm arm;
  std::vector<double> q, qd, tau;
  std::size_t lost_joints = 0;  // how many are told as NaN
  bool fails = false;
  double greatest = 0.0;  // rad/s^2, of any joint
};

class BenchHardware : public hardware_interface::SystemInterface {
 public:
  explicit BenchHardware(std::shared_ptr<Bench> bench) : bench_(std::move(bench)) {}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // from jazzy on, but still there
  std::vector<hardware_interface::StateInterface> export_state_interfaces() override {
    std::vector<hardware_interface::StateInterface> states;
    for (std::size_t j = 0; j < bench_->q.size(); ++j) {
      states.emplace_back(info_.joints[j].name, "position", &bench_->q[j]);
      states.emplace_back(info_.joints[j].name, "velocity", &bench_->qd[j]);
    }
    return states;
  }
  std::vector<hardware_interface::CommandInterface> export_command_interfaces() override {
    std::vector<hardware_interface::CommandInterface> commands;
    for (std::size_t j = 0; j < bench_->q.size(); ++j) {
      commands.emplace_back(info_.joints[j].name, "effort", &bench_->tau[j]);
    }
    return commands;
  }
#pragma GCC diagnostic pop

  hardware_interface::return_type read(const rclcpp::Time&, const rclcpp::Duration&) override {
    bench_->read();
    return bench_->fails ? hardware_interface::return_type::ERROR
                         : hardware_interface::return_type::OK;
  }
  hardware_interface::return_type write(const rclcpp::Time&, const rclcpp::Duration&) override {
    bench_->step();
    return hardware_interface::return_type::OK;
  }

 private:
  std::shared_ptr<Bench> bench_;
};

// Precedes the follower: moves all joints back and forth by 0.3 rad in 2 s, until told otherwise.
class Leader : public controller_interface::ControllerInterface {
 public:
  explicit Leader(Robot robot) : robot_(std::move(robot)) {}

  InterfaceConfiguration command_interface_configuration() const override {
    InterfaceConfiguration commands{controller_interface::interface_configuration_type::INDIVIDUAL,
                                    {}};
    for (const std::string& joint : robot_.joints) {
      for (const char* interface : {"/position", "/velocity", "/acceleration"}) {
        commands.names.push_back(kFollower + ("/" + joint) + interface);
      }
    }
    return commands;
  }
  InterfaceConfiguration state_interface_configuration() const override {
    return {controller_interface::interface_configuration_type::NONE, {}};
  }
  CallbackReturn on_init() override { return CallbackReturn::SUCCESS; }

  return_type update(const rclcpp::Time&, const rclcpp::Duration&) override {
    if (fails) return return_type::ERROR;
    constexpr double kTurn = 2.0 * M_PI, kSpeed = kTurn / 2.0;
    const double angle = kSpeed * kPeriod * ++cycle_;
    bool written = true;
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
      const double A = j % 2 == 0 ? 0.15 : -0.15;
      auto* const command = &command_interfaces_[3 * j];
      written = command[0].set_value(robot_.q[j] + offset + A * (1.0 - std::cos(angle))) &&
                command[1].set_value(A * kSpeed * std::sin(angle)) &&
                command[2].set_value(A * kSpeed * kSpeed * std::cos(angle)) && written;
    }
    return written ? return_type::OK : return_type::ERROR;
  }

  bool fails = false;
  double offset = 0.0;  // rad

 private:
  Robot robot_;
  int cycle_ = 0;
};

class Faults : public testing::TestWithParam<Robot> {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }

  void SetUp() override {
    const Robot& robot = GetParam();
    const std::string urdf = urdfOf(robot);
    bench_ = std::make_shared<Bench>(robot, urdf);
    manager_ = managerOf(urdf);
    const auto file = rclcpp::parameter_map_from_yaml_file(configOf(robot));
    for (const char* name : {kFallback, kFollower}) load(name, file.at(std::string("/") + name));
    leader_ = std::make_shared<Leader>(robot);
    ASSERT_NE(manager_->add_controller(leader_, "leader", "Leader"), nullptr);
    ASSERT_EQ(manager_->configure_controller("leader"), return_type::OK);
    ASSERT_EQ(change({kFollower, "leader"}, {}), return_type::OK);
    run(0.2);  // the arm has fallen until the controllers were active
    bench_->greatest = 0.0;
    run(0.2);  // until it is fast
    moving_ = std::exchange(bench_->greatest, 0.0);
  }

  void TearDown() override {
    EXPECT_TRUE(manager_->shutdown_controllers());
    EXPECT_EQ(bench_->tau, std::vector<double>(bench_->tau.size(), 0.0));
  }

  // As the spawner does it.
  void load(const std::string& name, const std::vector<rclcpp::Parameter>& parameters) {
    manager_->set_parameter({name + ".params_file", configOf(GetParam())});
    for (const rclcpp::Parameter& parameter : parameters) {
      if (parameter.get_name() != "fallback_controllers") continue;
      manager_->set_parameter({name + ".fallback_controllers", parameter.as_string_array()});
    }
    const std::string type = name == kFallback ? "GravityCompensation" : "InverseDynamics";
    ASSERT_NE(
        manager_->load_controller(name, "inverse_dynamics_controllers/" + type + "Controller"),
        nullptr);
    ASSERT_EQ(manager_->configure_controller(name), return_type::OK);
  }

  return_type change(const std::vector<std::string>& start, const std::vector<std::string>& stop) {
    auto done = std::async(std::launch::async, [&] {
      // As soon as possible: else the controllers wait for as many cycles as the thread takes.
      return manager_->switch_controller(
          start, stop, controller_manager_msgs::srv::SwitchController::Request::STRICT, true);
    });
    while (done.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) cycle();
    return done.get();
  }

  void cycle() {
    const auto period = rclcpp::Duration::from_seconds(kPeriod);
    now_ += period;
    // Of the manager, which measures the periods of controllers.
    EXPECT_EQ(
        rcl_set_ros_time_override(manager_->get_clock()->get_clock_handle(), now_.nanoseconds()),
        RCL_RET_OK);
    manager_->read(now_, period);
    manager_->update(now_, period);
    manager_->write(now_, period);
  }

  void run(double seconds) {
    for (int k = 0; k < seconds / kPeriod; ++k) cycle();
  }

  bool isActive(const std::string& name) const {
    for (const auto& controller : manager_->get_loaded_controllers()) {
      if (controller.info.name == name) {
        return controller.c->get_node()->get_current_state().id() ==
               lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE;
      }
    }
    return false;
  }

  // The greatest acceleration of half a second.
  void expectGreatest(const std::string& fault, double bound) {
    run(0.5);
    std::cout << GetParam().name << ", " << fault << ": " << bench_->greatest
              << " rad/s^2; before: " << moving_ << " rad/s^2\n";
    RecordProperty("greatest_acceleration", std::to_string(bench_->greatest));
    EXPECT_LT(bench_->greatest, bound);
  }

  std::shared_ptr<Bench> bench_;
  std::shared_ptr<Leader> leader_;
  std::shared_ptr<controller_manager::ControllerManager> manager_;
  rclcpp::Time now_{0, 0, RCL_ROS_TIME};
  double moving_ = 0.0;  // greatest acceleration of the motion, rad/s^2

 private:
  // A manager with a component of its own besides the bench, as it loads no robot without any.
  std::shared_ptr<controller_manager::ControllerManager> managerOf(const std::string& urdf) const {
    const auto clock = std::make_shared<rclcpp::Clock>();
    const auto logger = rclcpp::get_logger("resources");
    const std::string idle = "<state_interface name='temperature'/>";
    auto resources = std::make_unique<hardware_interface::ResourceManager>(
        controlled(urdf, "mock_components/GenericSystem", idle), clock, logger, true, kRate);
    hardware_interface::HardwareComponentParams params;
    params.hardware_info = hardware_interface::parse_control_resources_from_urdf(
                               controlled(urdf, "Bench",
                                          "<command_interface name='effort'/><state_interface "
                                          "name='position'/><state_interface name='velocity'/>"))
                               .at(0);
    params.clock = clock;
    resources->import_component(std::make_unique<BenchHardware>(bench_), params);
    rclcpp_lifecycle::State active(lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE,
                                   hardware_interface::lifecycle_state_names::ACTIVE);
    resources->set_component_state("Bench", active);
    auto options = controller_manager::get_cm_node_options();
    options.parameter_overrides({{"update_rate", kRate}, {"use_sim_time", true}});
    return std::make_shared<controller_manager::ControllerManager>(
        std::move(resources), std::make_shared<rclcpp::executors::SingleThreadedExecutor>(),
        "manager", "", options);
  }

  // The robot with a hardware component of these interfaces of each joint.
  static std::string controlled(std::string urdf, const std::string& plugin,
                                const std::string& interfaces) {
    std::string component = "<ros2_control name='" + plugin + "' type='system'><hardware><plugin>" +
                            plugin + "</plugin></hardware>";
    for (const std::string& joint : GetParam().joints) {
      component += "<joint name='" + joint + "'>" + interfaces + "</joint>";
    }
    return urdf.insert(urdf.rfind("</robot>"), component + "</ros2_control>");
  }
};

TEST_P(Faults, NanOfAJointForAShortTime) {
  bench_->lost_joints = 1;
  run(0.03);
  bench_->lost_joints = 0;
  expectGreatest("NaN of a joint for 30 ms", 5.0);
  EXPECT_TRUE(isActive(kFallback));
  EXPECT_FALSE(isActive(kFollower));
}

TEST_P(Faults, StateOfAJointLostForGood) {
  bench_->lost_joints = 1;
  expectGreatest("state of a joint lost", 5.0);
  EXPECT_TRUE(isActive(kFallback));
}

TEST_P(Faults, StateOfAllJointsLostForGood) {
  bench_->lost_joints = bench_->q.size();
  expectGreatest("state of all joints lost", 300.0);
  EXPECT_TRUE(isActive(kFallback));
}

TEST_P(Faults, ReferenceThatJumps) {
  leader_->offset = 1.0;
  expectGreatest("reference that jumps by 1 rad", 3.0);
  EXPECT_TRUE(isActive(kFollower));
}

TEST_P(Faults, ControllerBeforeThatFails) {
  leader_->fails = true;
  expectGreatest("preceding controller that fails", 5.0);
  EXPECT_TRUE(isActive(kFallback));
}

TEST_P(Faults, ControllerBeforeThatFailsWhileAJointIsLost) {
  bench_->lost_joints = 1;
  leader_->fails = true;
  expectGreatest("preceding controller that fails without a joint's state", 5.0);
  EXPECT_TRUE(isActive(kFallback));
}

TEST_P(Faults, ControllerBeforeThatIsDeactivated) {
  ASSERT_EQ(change({}, {"leader"}), return_type::OK);
  expectGreatest("preceding controller deactivated", 3.0);
  EXPECT_TRUE(isActive(kFollower));
}

TEST_P(Faults, SwitchToTheFallback) {
  ASSERT_EQ(change({kFallback}, {"leader", kFollower}), return_type::OK);
  expectGreatest("switch to gravity compensation", 5.0);
}

// What the fallback is for.
TEST_P(Faults, DeactivationLeavesNoEffort) {
  ASSERT_EQ(change({}, {"leader", kFollower}), return_type::OK);
  EXPECT_EQ(bench_->tau, std::vector<double>(bench_->tau.size(), 0.0));
  expectGreatest("deactivation", 1e3);
  EXPECT_GT(bench_->greatest, 100.0);
}

TEST_P(Faults, AnErrorOfTheHardwareLeavesNoEffort) {
  bench_->fails = true;
  cycle();
  EXPECT_FALSE(isActive(kFollower));
  EXPECT_FALSE(isActive(kFallback));
  EXPECT_EQ(bench_->tau, std::vector<double>(bench_->tau.size(), 0.0));
}

INSTANTIATE_TEST_SUITE_P(Arms, Faults, testing::Values(ur10(), panda()),
                         [](const auto& robot) { return robot.param.name; });

}  // namespace
}  // namespace inverse_dynamics_simulation
