// SPDX-License-Identifier: Apache-2.0

/// @file
/// Loads of the live node's robot that may change while it runs: a body at the tip, gravity.

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
/// Changes are applied in steps of 10 ms. Invalid messages are logged with a reason and ignored.
class LiveLoad {
 public:
  using PayloadRamp = inverse_dynamics_control::PayloadRamp;

  /// Throws inverse_dynamics_solver::InvalidParameterValueException: the parameters make no possible
  /// body.
  LiveLoad(rclcpp::Node& node, const live_node::Params& params);

  /// Makes a robot carry the present body.
  ///
  /// @throws inverse_dynamics_solver::Exception: it can't, or its gravity can't change where an IMU
  ///         is to change it.
  std::shared_ptr<PayloadRamp> make(const LiveRobot& robot) const;

  /// Applies loads to this robot from now on.
  void use(std::shared_ptr<PayloadRamp> ramp, const LiveRobot& robot);

  /// The body that is carried once the ramp has ended.
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
  std::optional<Eigen::Vector3d> gravity_;  // the latest one received; none: the solver's own
  std::optional<GravityFromImu> imu_;
  LiveRobot robot_;  // without a solver until there is one
  inverse_dynamics_solver::VariableGravity* variable_ = nullptr;  // null if gravity is fixed
  rclcpp::Clock steady_{RCL_STEADY_TIME};
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr gravities_;
  rclcpp::Subscription<sensor_msgs::msg::Imu>::SharedPtr imus_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_ros
