// SPDX-License-Identifier: Apache-2.0

/// @file
/// Computed torques of a robot that is running, and how far the measured ones are from them.
///
///     ros2 run inverse_dynamics_ros live --ros-args -p plugin_name:=package/Class
///     ros2 component load /container inverse_dynamics_ros inverse_dynamics_ros::LiveNode
///
// clang-format off
/// | topic               | type                              |                                        |
/// |---------------------|-----------------------------------|----------------------------------------|
/// | joint_states        | sensor_msgs/msg/JointState        | in: position, velocity, effort         |
/// | robot_description   | std_msgs/msg/String               | in, latched; unless the parameter is   |
/// | ~/payload           | geometry_msgs/msg/InertiaStamped  | in: what the tip carries               |
/// | ~/gravity           | geometry_msgs/msg/Vector3Stamped  | in: where things fall                  |
/// | imu                 | sensor_msgs/msg/Imu               | in: the same, if gravity_from_imu.use  |
/// | ~/torques           | sensor_msgs/msg/JointState        | out: effort is the computed torque     |
/// | ~/residual          | sensor_msgs/msg/JointState        | out: effort is measured - computed     |
/// | ~/external_torques  | sensor_msgs/msg/JointState        | out, if external_torques.enabled       |
/// | ~/wrench            | geometry_msgs/msg/WrenchStamped   | out, then: on the tip                  |
/// | ~/contact           | inverse_dynamics_msgs/msg/Contact | out, then: whether something touches   |
/// | ~/estimated_payload | geometry_msgs/msg/InertiaStamped  | out, latched: of the action            |
/// | /diagnostics        | diagnostic_msgs/DiagnosticArray   | out                                    |
// clang-format on
///
/// Action: ~/estimate_payload, inverse_dynamics_msgs/action/EstimatePayload.
///
/// Messages out have the stamp of the joint state they belong to. Accelerations come from a causal
/// filter of the velocities, late by 1 / (pi cutoff) s: see online_derivative.hpp. While that
/// filter settles, and for a joint state that can't be used, nothing is published.

#pragma once

#include <memory>
#include <rclcpp/node.hpp>
#include <rclcpp/node_options.hpp>

namespace inverse_dynamics_ros {

/// The node `live`, as a component. Parameters: src/live_node_parameters.yaml and docs/ros2.md.
///
/// One thread at a time: all callbacks are in the node's default group.
class LiveNode : public rclcpp::Node {
 public:
  /// @throws UserError, inverse_dynamics_solver::Exception, rclcpp::exceptions::...: parameters,
  ///         plugin or description that can't be used.
  explicit LiveNode(const rclcpp::NodeOptions& options);
  ~LiveNode() override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace inverse_dynamics_ros
