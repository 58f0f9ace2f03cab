// SPDX-License-Identifier: Apache-2.0
/// @file
/// The model's torque for the wished motion, added to the effort of another controller.
///
///     tau = effort + P e + D ed + H qdd_ref + C qd + g + f
///
/// Any solver will do: no error goes through H. Motion and effort come from the controllers before
/// it, or from the topic ~/reference; P and D are this controller's own gains, zero by default.
/// docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include <memory>
#include <vector>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace feed_forward_controller {
class ParamListener;
}

namespace inverse_dynamics_controllers {

/// The law FeedForward of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class FeedForwardController : public ChainableController {
 public:
  FeedForwardController();
  ~FeedForwardController() override;

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

  std::shared_ptr<feed_forward_controller::ParamListener> parameters_;
  std::unique_ptr<Configured> configured_;
};

}  // namespace inverse_dynamics_controllers
