// SPDX-License-Identifier: Apache-2.0
/// @file
/// A force-torque sensor at the tip without a sensor: what touches the robot, from joint efforts.
///
///     external_wrench_broadcaster:
///       ros__parameters:
///         plugin_name: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL
///         ids: {root: base_link, tip: tool0}
///         noise: [0.3]                  # N m
///
/// docs/ros2_controllers.md has the parameters, sign and frame, and what is promised.
#pragma once

#include <memory>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace external_wrench_broadcaster {
class ParamListener;
}

namespace inverse_dynamics_controllers {

class ArmSource;

/// External torques, wrench at the tip and contacts of an arm: state interfaces that other
/// controllers claim, as those of a sensor named like this controller, and topics.
///
/// State interfaces (jazzy and newer): `NAME/force.x`, ..., `NAME/torque.z`, what the surroundings
/// exert on the tip, about its origin, in its axes: as force_torque_sensor_broadcaster's. Zero while
/// there is no estimate, NaN while the controller isn't active.
/// Real time: update: no allocation, lock, exception or system call of its own.
class ExternalWrenchBroadcaster : public Broadcaster {
 public:
  ExternalWrenchBroadcaster();
  ~ExternalWrenchBroadcaster() override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State& state) override;

 protected:
  controller_interface::return_type measure(const rclcpp::Time& time,
                                            const rclcpp::Duration& period) noexcept override;

 private:
  struct Configured;

  std::unique_ptr<ArmSource> arm_source_;
  std::shared_ptr<external_wrench_broadcaster::ParamListener> parameters_;
  std::unique_ptr<Configured> configured_;
};

}  // namespace inverse_dynamics_controllers
