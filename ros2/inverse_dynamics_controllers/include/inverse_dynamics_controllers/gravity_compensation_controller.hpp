// SPDX-License-Identifier: Apache-2.0
/// @file
/// Hand guiding: the arm stays where it is put.
///
///     tau = g(q) - D qd + f
///
/// docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include <controller_interface/controller_interface.hpp>
#include <memory>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace gravity_compensation_controller {
class ParamListener;
}

namespace inverse_dynamics_controllers {

class ArmSource;

/// The law GravityCompensation of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class GravityCompensationController : public Strict<controller_interface::ControllerInterface> {
 public:
  GravityCompensationController();
  ~GravityCompensationController() override;

  controller_interface::return_type update(const rclcpp::Time& time,
                                           const rclcpp::Duration& period) override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State& state) override;

 private:
  struct Configured;

  std::unique_ptr<ArmSource> arm_source_;
  std::shared_ptr<gravity_compensation_controller::ParamListener> parameters_;
  std::unique_ptr<Configured> configured_;
};

}  // namespace inverse_dynamics_controllers
