// SPDX-License-Identifier: Apache-2.0

/// @file
/// What loads the robot of the live node and may change while it runs: a body at the tip, gravity.

#pragma once

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <inverse_dynamics_control/carried_body.hpp>
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

  /// Throws inverse_dynamics_solver::InvalidParameterValueException: the parameters make no possible
  /// body.
  LiveLoad(rclcpp::Node& node, const live_node::Params& params);

  /// Has a robot carry what is carried now.
  ///
  /// @throws inverse_dynamics_solver::Exception: it can't, or its gravity can't change where an IMU
  ///         is to change it.
  std::shared_ptr<PayloadRamp> make(const LiveRobot& robot) const;

  /// Loads this robot from now on.
  void use(std::shared_ptr<PayloadRamp> ramp, const LiveRobot& robot);

  /// What is carried, or will be when the ramp has ended.
  inverse_dynamics_control::RigidBody body() const { return carried_.body(); }

  void report(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  void openImu();
  void takeGravity(const geometry_msgs::msg::Vector3Stamped& message);
  void takeImu(const sensor_msgs::msg::Imu& message);
  void step();

  rclcpp::Node& node_;
  live_node::Params::GravityFromImu params_;
  inverse_dynamics_control::CarriedBody<rclcpp::Node, geometry_msgs::msg::InertiaStamped> carried_;
  std::optional<Eigen::Vector3d> gravity_;  // what was asked for last; none: the solver's own
  std::optional<GravityFromImu> imu_;
  LiveRobot robot_;  // without a solver until there is one
  inverse_dynamics_solver::VariableGravity* variable_ = nullptr;  // null if gravity is fixed
  rclcpp::Clock steady_{RCL_STEADY_TIME};
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr gravities_;
  rclcpp::Subscription<sensor_msgs::msg::Imu>::SharedPtr imus_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_ros
