// SPDX-License-Identifier: Apache-2.0
/// @file
/// Computed torque control, also called inverse dynamics control, as a controller of ros2_control.
///
///     tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f
///
/// What it follows comes from the controller before it (a joint_trajectory_controller with
/// command_interfaces position, velocity, acceleration), or from the topic ~/reference.
/// docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include <memory>
#include <vector>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace inverse_dynamics_controller {
class ParamListener;
}

namespace inverse_dynamics_controllers {

/// The law ComputedTorque of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class InverseDynamicsController : public ChainableController {
 public:
  InverseDynamicsController();
  ~InverseDynamicsController() override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State& state) override;

 protected:
  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override;
  bool on_set_chained_mode(bool chained_mode) override;
  void readReferenceTopic() noexcept override;
  controller_interface::return_type update_and_write_commands(
      const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  struct Configured;

  std::shared_ptr<inverse_dynamics_controller::ParamListener> parameters_;
  std::unique_ptr<Configured> configured_;
};

}  // namespace inverse_dynamics_controllers
