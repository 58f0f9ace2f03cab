// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>
#include <std_msgs/msg/string.hpp>
#include <thread>

#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"
#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

using Numbers = std::vector<double>;

class Refusals : public ControllerFixture<InverseDynamicsController> {
 protected:
  static Parameters good() {
    Parameters parameters = ControllerFixture::good();
    parameters["gains.natural_frequency"] = rclcpp::ParameterValue(Numbers{5.0});
    return parameters;
  }

  // Good parameters but one.
  static Parameters but(const std::string& name, const rclcpp::ParameterValue& value) {
    Parameters parameters = good();
    parameters[name] = value;
    return parameters;
  }

  void expectRefused(const Parameters& parameters, const std::string& text) {
    EXPECT_FALSE(configure(parameters));
    EXPECT_TRUE(log.has("ERROR: " + text)) << log.text();
  }
};

TEST_F(Refusals, ASolverWhoseInertiaIsNotPhysical) {
  expectRefused(
      but("plugin_name", rclcpp::ParameterValue(kUr10)),
      "parameter 'plugin_name': not fit for computed torque: expected a solver whose inertia "
      "matrix is symmetric and positive definite, got "
      "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10, whose inertiaIsPhysical() is "
      "false; use inverse_dynamics_controllers/FeedForwardController with it, or here a solver "
      "made from the robot's URDF");
}

TEST_F(Refusals, NoSolver) {
  expectRefused(but("plugin_name", rclcpp::ParameterValue("")),
                "parameter 'plugin_name': not set: expected a solver, package/Class, got nothing; "
                "set it to one of ");
}

TEST_F(Refusals, AnUnknownSolver) {
  expectRefused(but("plugin_name", rclcpp::ParameterValue("kdl/Solver")), "");
  EXPECT_TRUE(log.has("kdl/Solver")) << log.text();
  EXPECT_TRUE(log.has(kKdl)) << log.text();
}

TEST_F(Refusals, AMistypedParameter) {
  EXPECT_FALSE(init(but("tolerated_fault_time", rclcpp::ParameterValue("long"))));
  EXPECT_TRUE(log.has("tolerated_fault_time")) << log.text();
}

TEST_F(Refusals, AMistypedParameterOfTheSolver) {
  expectRefused(but("ids.gravity", rclcpp::ParameterValue("down")), "");
  EXPECT_TRUE(log.has("ids.gravity")) << log.text();
}

TEST_F(Refusals, AMisspeltParameterOfTheSolver) {
  expectRefused(but("ids.gravty", rclcpp::ParameterValue(Numbers{0.0, 0.0, -9.81})),
                "parameter 'ids.gravty': the solver doesn't know it: expected one of "
                "ids.allow_massless, ids.attached, ");
}

TEST_F(Refusals, AMisspeltParameter) {
  expectRefused(but("limits.effrot", rclcpp::ParameterValue(Numbers{1.0})),
                "parameter 'limits.effrot': the node doesn't declare it; did you mean "
                "'limits.effort'?");
}

TEST_F(Refusals, OnlyAWarningInASectionForOtherNodesToo) {
  const std::string file = ::testing::TempDir() + "sections.yaml";
  const std::vector<std::string> arguments = {"--ros-args", "--params-file", file};
  std::ofstream(file) << "/**: {ros__parameters: {limits.effrot: [1.0]}}\n"
                         "another: {ros__parameters: {cutoff: 5.0}}\n";
  EXPECT_TRUE(configure(good(), arguments)) << log.text();
  EXPECT_TRUE(
      log.has("WARN: parameter 'limits.effrot': the node doesn't declare it; did you mean "
              "'limits.effort'?; ignored, since its section is for other nodes, too"))
      << log.text();
}

TEST_F(Refusals, AMisspeltParameterInASectionOfTheController) {
  const std::string file = ::testing::TempDir() + "own_section.yaml";
  std::ofstream(file) << "/**: {ros__parameters: {limits.effrot: [1.0]}}\n"
                         "/**/under_test: {ros__parameters: {limits.effrot: [1.0]}}\n";
  EXPECT_FALSE(configure(good(), {"--ros-args", "--params-file", file}));
  EXPECT_TRUE(log.has("ERROR: parameter 'limits.effrot': ")) << log.text();
}

TEST_F(Refusals, NothingOfWhatTheSpawnerReadsInTheSameFile) {
  Parameters parameters = but("type", rclcpp::ParameterValue("package/Class"));
  parameters["fallback_controllers"] = rclcpp::ParameterValue(std::vector<std::string>{"other"});
  parameters["async_parameters.thread_priority"] = rclcpp::ParameterValue(40);
  EXPECT_TRUE(configure(parameters)) << log.text();
}

TEST_F(Refusals, NoGains) {
  expectRefused(but("gains.natural_frequency", rclcpp::ParameterValue(Numbers{})),
                "parameter 'gains.natural_frequency': not set: expected numbers above zero "
                "[rad/s], got nothing; start with 10 and double it while the arm is quiet");
}

TEST_F(Refusals, GainsForOtherJoints) {
  expectRefused(but("gains.natural_frequency", rclcpp::ParameterValue(Numbers{5.0, 6.0})),
                "parameter 'gains.natural_frequency': wrong size: expected 6 numbers, or one for "
                "all, got 2; give one for each of the joints shoulder_pan_joint, ");
}

TEST_F(Refusals, GainsThatAreUnstableInTheSampledLoop) {
  Parameters parameters = but("gains.natural_frequency", rclcpp::ParameterValue(Numbers{200.0}));
  parameters["update_rate"] = rclcpp::ParameterValue(125);  // slower than the manager
  expectRefused(
      parameters,
      "parameter 'gains': joint shoulder_pan_joint: unstable in the sampled loop: expected "
      "Kp T <= 2 Kd and Kd T < 2, got Kp = 40000/s^2, Kd = 400/s every 0.008 s; lower "
      "natural_frequency; a damping_ratio of 1 suits most arms");
}

TEST_F(Refusals, OtherJoints) {
  expectRefused(but("joints", rclcpp::ParameterValue(std::vector<std::string>{"a", "b"})),
                "parameter 'joints': wrong number of names: expected 6, in the order of "
                "shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, "
                "wrist_2_joint, wrist_3_joint, got 2 (a, b); correct them");
}

TEST_F(Refusals, APeriodThatIsNotThatOfTheUpdateRate) {
  expectRefused(but("period", rclcpp::ParameterValue(0.002)),
                "parameter 'period': not that of the control loop: expected 0.001 s (update_rate "
                "is 1000 Hz), got 0.002 s; leave it out");
}

TEST_F(Refusals, ButNotAPeriodThatAgrees) {
  EXPECT_TRUE(configure(but("period", rclcpp::ParameterValue(kPeriod)))) << log.text();
}

TEST_F(Refusals, JointsThatTheRobotDescriptionLacks) {
  std::vector<std::string> others = ur10Joints();
  others[1] = "left_shoulder";
  others[2] = "left_elbow";
  expectRefused(but("joints", rclcpp::ParameterValue(others)),
                "parameter 'joints': not in the robot description: expected its names of the "
                "chain's joints (shoulder_pan_joint, shoulder_lift_joint, elbow_joint, "
                "wrist_1_joint, wrist_2_joint, wrist_3_joint), got left_shoulder, left_elbow; set "
                "'joints' to them, or 'limits.effort' if the hardware names its joints otherwise");
}

TEST_F(Refusals, LimitsOfEffortThatNobodyKnows) {
  std::string description = ur10Description();
  const std::string limit = " effort=\"330.0\"";
  ASSERT_NE(description.find(limit), std::string::npos);
  description.replace(description.find(limit), limit.size(), " effort=\"-1\"");
  expectRefused(but("robot_description", rclcpp::ParameterValue(description)),
                "parameter 'limits.effort': not set: expected limits of effort [N m], here or in "
                "the robot description, got neither for all joints; set it; .inf where the robot "
                "limits its effort by itself");
}

TEST_F(Refusals, WithoutARobotDescriptionConfiguringDoesNotWait) {
  const auto begin = std::chrono::steady_clock::now();
  expectRefused(but("robot_description", rclcpp::ParameterValue("")), "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
  EXPECT_TRUE(
      log.has("WARN: no robot description: nothing has come on /robot_description so far; go on "
              "without, with what the solver itself knows; configure again once it is published, "
              "or set the parameter robot_description"))
      << log.text();
}

TEST_F(Refusals, ARobotDescriptionThatComesLateIsTakenWhenConfiguredAgain) {
  EXPECT_FALSE(configure(but("robot_description", rclcpp::ParameterValue(""))));
  const auto sender = std::make_shared<rclcpp::Node>("sender");
  const auto publisher = sender->create_publisher<std_msgs::msg::String>(
      "robot_description", rclcpp::QoS(1).transient_local());
  std_msgs::msg::String description;
  description.data = ur10Description();
  publisher->publish(description);
  EXPECT_TRUE(spinUntil([this] {
    return controller.configure().id() == lifecycle_msgs::msg::State::PRIMARY_STATE_INACTIVE;
  })) << log.text();
}

TEST_F(Refusals, ARobotDescriptionThatIsUnderWayIsWaitedFor) {
  const auto sender = std::make_shared<rclcpp::Node>("sender");
  const auto publisher = sender->create_publisher<std_msgs::msg::String>(
      "robot_description", rclcpp::QoS(1).transient_local());
  ASSERT_TRUE(init(but("robot_description", rclcpp::ParameterValue("")))) << log.text();
  ASSERT_TRUE(spinUntil([&] { return publisher->get_subscription_count() > 0; }));
  std::thread late([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    std_msgs::msg::String description;
    description.data = ur10Description();
    publisher->publish(description);
  });
  EXPECT_EQ(controller.configure().id(), lifecycle_msgs::msg::State::PRIMARY_STATE_INACTIVE)
      << log.text();
  late.join();
}

TEST_F(Refusals, ActivationWithoutASolver) {
  ASSERT_TRUE(init(good())) << log.text();
  EXPECT_EQ(controller.on_activate(rclcpp_lifecycle::State()),
            controller_interface::CallbackReturn::FAILURE);
  EXPECT_TRUE(
      log.has("ERROR: activation: the controller has no solver: expected a controller "
              "that is configured, got one that isn't; configure it first, and see that "
              "this succeeds"))
      << log.text();
}

TEST_F(Refusals, ActivationWithoutAMeasuredState) {
  ASSERT_TRUE(configure(good())) << log.text();
  hardware.qd[2] = kNan;
  EXPECT_FALSE(activate());
  EXPECT_TRUE(
      log.has("ERROR: joint elbow_joint: no measured state: expected a finite position "
              "and velocity, got NaN or infinity; see that the hardware component is "
              "active, and activate the controller again"))
      << log.text();
}

TEST_F(Refusals, ActivationWithoutAnInterface) {
  ASSERT_TRUE(configure(good())) << log.text();
  auto states = hardware.states();
  states.pop_back();  // the effort of the last joint
  states.pop_back();  // its velocity
  controller.assign_interfaces(hardware.commands(), std::move(states));
  EXPECT_NE(controller.get_node()->activate().id(),
            lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE);
  EXPECT_TRUE(
      log.has("ERROR: state interface: missing: expected wrist_3_joint/velocity, got 16 "
              "others; "))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
