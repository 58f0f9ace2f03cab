// SPDX-License-Identifier: Apache-2.0

/// @file
/// What loads the robot of the live node and may change while it runs: a body at the tip, gravity.

#pragma once

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <inverse_dynamics_control/payload_ramp.hpp>
#include <inverse_dynamics_ros/live_node_parameters.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/imu.hpp>

#include "gravity_from_imu.hpp"
#include "live_robot.hpp"

namespace inverse_dynamics_ros {

/// Parameters `payload.*`, topics ~/payload, ~/gravity, imu.
///
/// Changes are made in steps of 10 ms. What can't be used is refused with a reason in the log, and
/// changes nothing.
class LiveLoad {
 public:
  using PayloadRamp = inverse_dynamics_control::PayloadRamp;

  /// @param listener  of the node's parameters; it is kept.
  LiveLoad(rclcpp::Node& node, std::shared_ptr<live_node::ParamListener> listener);

  /// Has a robot carry what is carried now.
  ///
  /// @throws inverse_dynamics_solver::Exception: it can't, or its gravity can't change where an IMU
  ///         is to change it.
  std::unique_ptr<PayloadRamp> make(const LiveRobot& robot) const;

  /// Loads this robot from now on.
  void use(std::unique_ptr<PayloadRamp> ramp, const LiveRobot& robot);

  /// What is carried, or will be when the ramp has ended.
  const inverse_dynamics_control::RigidBody& body() const { return body_; }

  void report(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  rcl_interfaces::msg::SetParametersResult check(
      const std::vector<rclcpp::Parameter>& wanted) const;
  inverse_dynamics_control::RigidBody bodyOfParameters(
      const std::vector<rclcpp::Parameter>& wanted = {}) const;
  void openImu();
  void aimAt(const inverse_dynamics_control::RigidBody& body);
  void takePayload(const geometry_msgs::msg::InertiaStamped& message);
  void takeGravity(const geometry_msgs::msg::Vector3Stamped& message);
  void takeImu(const sensor_msgs::msg::Imu& message);
  void step();

  rclcpp::Node& node_;
  std::shared_ptr<live_node::ParamListener> listener_;
  live_node::Params params_;
  inverse_dynamics_control::RigidBody body_;  // what was asked for last
  std::optional<Eigen::Vector3d> gravity_;    // what was asked for last; none: the solver's own
  std::optional<GravityFromImu> imu_;
  LiveRobot robot_;                    // without a solver until there is one
  std::unique_ptr<PayloadRamp> ramp_;  // null until then
  inverse_dynamics_solver::VariableGravity* variable_ = nullptr;  // null if gravity is fixed
  rclcpp::Clock steady_{RCL_STEADY_TIME};
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr checking_;
  rclcpp::Subscription<geometry_msgs::msg::InertiaStamped>::SharedPtr payloads_;
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr gravities_;
  rclcpp::Subscription<sensor_msgs::msg::Imu>::SharedPtr imus_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_ros
