// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/external_wrench_broadcaster.hpp"

#include <cmath>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <inverse_dynamics_msgs/msg/contact.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <semantic_components/force_torque_sensor.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

using Numbers = std::vector<double>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kExact = 1e-5;   // of 20 N: what the damping of the least squares leaves
constexpr double kSettled = 0.5;  // s: 30 time constants

template <class Controller>
auto exportedStates(Controller& controller, int) -> decltype(controller.export_state_interfaces()) {
  return controller.export_state_interfaces();
}
template <class Controller>
std::vector<std::shared_ptr<hardware_interface::StateInterface>> exportedStates(Controller&, long) {
  return {};  // humble
}

class ExternalWrenchBroadcasterTest : public ControllerFixture<ExternalWrenchBroadcaster> {
 protected:
  void SetUp() override { hardware.set(q, Eigen::VectorXd::Zero(6)); }

  static Parameters good() {
    Parameters parameters = ControllerFixture::good();
    parameters.erase("damping.values");
    parameters["noise"] = rclcpp::ParameterValue(Numbers{1e-3});
    return parameters;
  }

  static Parameters but(const std::string& name, const rclcpp::ParameterValue& value) {
    Parameters parameters = good();
    parameters[name] = value;
    return parameters;
  }

  void expectRefused(const Parameters& parameters, const std::string& text) {
    EXPECT_FALSE(configure(parameters));
    EXPECT_TRUE(log.has("ERROR: " + text)) << log.text();
  }

  bool start(const Parameters& parameters) {
    if (!configure(parameters)) return false;
    states_ = exportedStates(controller, 0);
    return activate();
  }

  // The arm at rest, held by its drives while something pushes its tip.
  void hold(const char* plugin = kKdl) {
    const auto model = solver(plugin);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
    const auto& kinematics = dynamic_cast<const inverse_dynamics_solver::Kinematics&>(*model);
    hardware.setEffort(model->getTorques(q, zero, zero) -
                       kinematics.getTipJacobian(q).transpose() * push);
    const Eigen::Matrix3d R = kinematics.getTipPose(q).R;
    expected << R.transpose() * push.head<3>(), R.transpose() * push.tail<3>();
  }

  return_type run(double seconds) {
    return_type result = return_type::OK;
    for (double t = 0; t < seconds && result == return_type::OK; t += kPeriod) result = update();
    return result;
  }

  // What another controller reads, as admittance_controller does.
  Vector6 sensed() {
    std::vector<LoanedStateInterface> states = loans<LoanedStateInterface>(states_);
    semantic_components::ForceTorqueSensor sensor("under_test");
    EXPECT_TRUE(sensor.assign_loaned_state_interfaces(states));
    geometry_msgs::msg::Wrench wrench;
    sensor.get_values_as_message(wrench);
    Vector6 values;
    values << wrench.force.x, wrench.force.y, wrench.force.z, wrench.torque.x, wrench.torque.y,
        wrench.torque.z;
    return values;
  }

  const Eigen::VectorXd q = vec({0.3, -1.2, 0.9, -0.4, 0.7, 0.2});
  // Force, then torque about the tip's origin, by the surroundings on the tip, root axes.
  const Vector6 push = (Vector6() << 20, -10, 5, 1, -2, 0.5).finished();
  Vector6 expected;  // the same in tip axes

 private:
  decltype(exportedStates(std::declval<ExternalWrenchBroadcaster&>(), 0)) states_;
};

#define REQUIRE_STATES \
  if (!kExportsStates) GTEST_SKIP() << "controllers have no state interfaces in this release"

TEST_F(ExternalWrenchBroadcasterTest, IsAForceTorqueSensorForOtherControllers) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(good())) << log.text();
  hold();
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT((sensed() - expected).norm(), kExact * push.norm()) << sensed().transpose();
  EXPECT_EQ(log.text(), "");
}

TEST_F(ExternalWrenchBroadcasterTest, TakesASolverWhoseInertiaIsNotPhysical) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(but("plugin_name", rclcpp::ParameterValue(kUr10)))) << log.text();
  hold(kUr10);
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT((sensed() - expected).norm(), kExact * push.norm()) << sensed().transpose();
}

TEST_F(ExternalWrenchBroadcasterTest, AnEffortThatIsNotANumberGivesZeroAndABeginningFromZero) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(good())) << log.text();
  hold();
  run(kSettled);
  const double effort = hardware.measured_tau[2];
  hardware.measured_tau[2] = kNan;
  EXPECT_EQ(update(), return_type::OK);
  EXPECT_EQ(sensed(), Vector6::Zero());
  hardware.measured_tau[2] = effort;
  for (double t = 0, before = 0; t < kSettled; t += kPeriod) {
    EXPECT_EQ(update(), return_type::OK);
    const double now = sensed().norm();
    EXPECT_LT(std::abs(now - before), 0.1 * push.norm());  // no jump
    before = now;
  }
  EXPECT_LT((sensed() - expected).norm(), kExact * push.norm());
}

TEST_F(ExternalWrenchBroadcasterTest, StatesThatStayNanEndTheEstimate) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(good())) << log.text();
  hold();
  run(kSettled);
  hardware.q[0] = kNan;
  EXPECT_EQ(run(0.015), return_type::OK);
  EXPECT_EQ(run(0.010), return_type::ERROR);
  EXPECT_EQ(sensed(), Vector6::Zero());
  hardware.q[0] = q[0];
  EXPECT_EQ(update(), return_type::ERROR);
  EXPECT_TRUE(spinUntil([this] { return log.has("no wrench until the controller is activated"); }))
      << log.text();
}

TEST_F(ExternalWrenchBroadcasterTest, WaitsForHardwareThatMeasuresNoEffortBeforeTheFirstCommand) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(but("start_time", rclcpp::ParameterValue(0.5)))) << log.text();
  hold();
  const std::vector<double> effort = hardware.measured_tau;
  hardware.measured_tau.assign(6, kNan);
  EXPECT_EQ(run(0.4), return_type::OK);
  EXPECT_EQ(sensed(), Vector6::Zero());
  hardware.measured_tau = effort;
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT((sensed() - expected).norm(), kExact * push.norm());
  hardware.measured_tau.assign(6, kNan);
  EXPECT_EQ(run(0.1), return_type::ERROR);
}

TEST_F(ExternalWrenchBroadcasterTest, GivesUpWhereNoEffortIsEverMeasured) {
  ASSERT_TRUE(start(but("start_time", rclcpp::ParameterValue(0.5)))) << log.text();
  hardware.measured_tau.assign(6, kNan);
  EXPECT_EQ(run(0.6), return_type::ERROR);
}

TEST_F(ExternalWrenchBroadcasterTest, BeginsAgainAfterAGapInTime) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(good())) << log.text();
  hold();
  run(kSettled);
  EXPECT_EQ(update(2.0), return_type::OK);
  EXPECT_EQ(sensed(), Vector6::Zero());
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT((sensed() - expected).norm(), kExact * push.norm());
}

TEST_F(ExternalWrenchBroadcasterTest, ThereIsNoWrenchWhileItIsNotActive) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(good())) << log.text();
  EXPECT_EQ(sensed(), Vector6::Zero());
  hold();
  run(kSettled);
  controller.get_node()->deactivate();
  EXPECT_TRUE(sensed().array().isNaN().all());
}

TEST_F(ExternalWrenchBroadcasterTest, ALoadThatItKnowsIsNoWrench) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(but("payload.mass", rclcpp::ParameterValue(3.0)))) << log.text();
  const auto model = solver();
  inverse_dynamics_solver::RigidBody load;
  load.mass = 3.0;
  dynamic_cast<inverse_dynamics_solver::Payload&>(*model).setPayload("load", load);
  hardware.setEffort(model->getGravityVector(q));
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT(sensed().norm(), 1e-6);
}

TEST_F(ExternalWrenchBroadcasterTest, WhatTheRobotCompensatesIsNotInItsEfforts) {
  REQUIRE_STATES;
  ASSERT_TRUE(start(but("compensated_by_robot.gravity", rclcpp::ParameterValue(true))))
      << log.text();
  EXPECT_EQ(run(kSettled), return_type::OK);
  EXPECT_LT(sensed().norm(), 1e-6);
}

TEST_F(ExternalWrenchBroadcasterTest, PublishesWrenchTorquesAndContact) {
  Parameters parameters = but("contact.thresholds", rclcpp::ParameterValue(Numbers{1.0}));
  parameters["state_publish_rate"] = rclcpp::ParameterValue(1000.0);
  ASSERT_TRUE(start(parameters)) << log.text();
  geometry_msgs::msg::WrenchStamped wrench;
  sensor_msgs::msg::JointState torques;
  inverse_dynamics_msgs::msg::Contact contact;
  const auto listener = std::make_shared<rclcpp::Node>("listener");
  const auto wrenches = listener->create_subscription<geometry_msgs::msg::WrenchStamped>(
      "under_test/wrench", 10, [&](const geometry_msgs::msg::WrenchStamped& m) { wrench = m; });
  const auto efforts = listener->create_subscription<sensor_msgs::msg::JointState>(
      "under_test/external_torques", 10,
      [&](const sensor_msgs::msg::JointState& m) { torques = m; });
  const auto contacts = listener->create_subscription<inverse_dynamics_msgs::msg::Contact>(
      "under_test/contact", 10, [&](const inverse_dynamics_msgs::msg::Contact& m) { contact = m; });
  executor.add_node(listener);
  hold();
  run(kSettled);
  const auto settled = [&] { return std::abs(wrench.wrench.force.x - expected[0]) < 1e-3; };
  EXPECT_TRUE(
      spinUntil([&] { return update() == return_type::OK && settled() && contact.contact; }));

  EXPECT_GT(contact.excess, 0.5);
  EXPECT_NE(std::find(ur10Joints().begin(), ur10Joints().end(), contact.joint), ur10Joints().end());
  EXPECT_EQ(wrench.header.frame_id, "tool0");
  EXPECT_NEAR(wrench.wrench.torque.z, expected[5], 1e-3);
  // What the robot spends on its surroundings: the sign of all external torques of this library.
  ASSERT_EQ(torques.name, ur10Joints());
  const Eigen::VectorXd excess =
      Eigen::Map<const Eigen::VectorXd>(hardware.measured_tau.data(), 6) -
      solver()->getGravityVector(q);
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_NEAR(torques.effort.at(j), excess[static_cast<Eigen::Index>(j)], 1e-3);
  }
}

TEST_F(ExternalWrenchBroadcasterTest, SaysWhereTheJointsDoNotFeelAWrench) {
  Parameters parameters = but("noise", rclcpp::ParameterValue(Numbers{0.3}));
  ASSERT_TRUE(start(parameters)) << log.text();
  hardware.set(vec({0.3, -1.2, 0.0, -0.4, 0.0, 0.2}), Eigen::VectorXd::Zero(6));  // stretched
  run(kSettled);
  EXPECT_TRUE(spinUntil([this] { return log.has("the joints don't feel"); })) << log.text();
}

TEST_F(ExternalWrenchBroadcasterTest, DeclaresNoParameterOfCommands) {
  ASSERT_TRUE(configure(good())) << log.text();
  for (const std::string prefix : {"damping", "friction", "limits"}) {
    EXPECT_EQ(controller.get_node()->list_parameters({prefix}, 0).names,
              std::vector<std::string>());
  }
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesToGuessTheNoise) {
  expectRefused(
      but("noise", rclcpp::ParameterValue(Numbers{})),
      "parameter 'noise': not set: expected the standard deviation of the external torque "
      "of each joint without contact [N m], got nothing; take it from contacts.json of "
      "`ids contact`, or from ~/external_torques at rest");
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesNumbersForOtherJoints) {
  expectRefused(but("contact.thresholds", rclcpp::ParameterValue(Numbers{1.0, 2.0})),
                "parameter 'contact.thresholds': wrong size: expected 6 numbers, or one for all");
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesAMomentumThatIsNotPhysical) {
  Parameters parameters = but("estimator", rclcpp::ParameterValue("momentum"));
  parameters["plugin_name"] = rclcpp::ParameterValue(kUr10);
  expectRefused(parameters, "");
  EXPECT_TRUE(log.has("inertia")) << log.text();
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesAFrameWithoutAName) {
  Parameters parameters = but("plugin_name", rclcpp::ParameterValue(kUr10));
  parameters.erase("ids.root");
  parameters.erase("ids.tip");
  expectRefused(parameters, "parameter 'frame_id': not set: expected the frame of the wrench");
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesALoopOfWhichEachCycleIsAGap) {
  expectRefused(but("update_rate", rclcpp::ParameterValue(20)),
                "parameter 'longest_period': shorter than the period of the control loop: expected "
                "more than 0.050000 s, got 0.020000");
}

TEST_F(ExternalWrenchBroadcasterTest, RefusesHardwareThatMeasuresNoEffort) {
  ASSERT_TRUE(configure(good())) << log.text();
  std::vector<LoanedStateInterface> states;
  for (LoanedStateInterface& state : hardware.states()) {
    if (state.get_interface_name() != "effort") states.push_back(std::move(state));
  }
  controller.assign_interfaces({}, std::move(states));
  EXPECT_NE(controller.get_node()->activate().id(),
            lifecycle_msgs::msg::State::PRIMARY_STATE_ACTIVE);
  EXPECT_TRUE(log.has("ERROR: state interface: missing: expected shoulder_pan_joint/effort"))
      << log.text();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
