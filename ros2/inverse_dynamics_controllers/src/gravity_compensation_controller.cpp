// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"

#include <inverse_dynamics_control/gravity_compensation.hpp>
#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_controllers/gravity_compensation_controller_parameters.hpp>
#include <memory>

#include "arm.hpp"
#include "control_loop.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using inverse_dynamics_control::GravityCompensation;
using inverse_dynamics_control::JointState;

/// All that a configuration makes, at once or not at all.
struct GravityCompensationController::Configured {
  ControlLoop loop;
  GravityCompensation law;
};

GravityCompensationController::GravityCompensationController() = default;
GravityCompensationController::~GravityCompensationController() = default;

controller_interface::InterfaceConfiguration
GravityCompensationController::command_interface_configuration() const {
  return configured_ ? configured_->loop.interfaces().commands() : nothing();
}

controller_interface::InterfaceConfiguration
GravityCompensationController::state_interface_configuration() const {
  return configured_ ? configured_->loop.interfaces().states() : nothing();
}

CallbackReturn GravityCompensationController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    arm_source_ = std::make_unique<ArmSource>(get_node(), ArmSource::Use::kCommand);
    parameters_ = std::make_shared<gravity_compensation_controller::ParamListener>(get_node());
  });
}

CallbackReturn GravityCompensationController::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    const Setup setup = arm_source_->setup(robotDescriptionOf(*this), get_update_rate());
    const auto params = parameters_->get_params();
    configured_ = std::make_unique<Configured>(Configured{
        ControlLoop(setup),
        GravityCompensation(setup.arm.solver, lawOptions(setup, params.friction.source))});
  });
}

CallbackReturn GravityCompensationController::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(configured_ != nullptr);
    configured_->loop.start(configured_->law, state_interfaces_, command_interfaces_, true);
  });
}

CallbackReturn GravityCompensationController::on_deactivate(const rclcpp_lifecycle::State&) {
  if (configured_) configured_->loop.stop(configured_->law, state_interfaces_, command_interfaces_);
  return CallbackReturn::SUCCESS;
}

CallbackReturn GravityCompensationController::on_cleanup(const rclcpp_lifecycle::State&) {
  configured_.reset();
  return CallbackReturn::SUCCESS;
}

controller_interface::return_type GravityCompensationController::update(
    const rclcpp::Time& time, const rclcpp::Duration& period) {
  if (!configured_) return controller_interface::return_type::ERROR;
  auto& [loop, law] = *configured_;
  const auto update = [&law = law](const JointState& state, double dt, Eigen::VectorXd& tau) {
    return law.update(state, dt, tau);
  };
  const auto result = loop.cycle(law, state_interfaces_, command_interfaces_, period, update);
  loop.publish(time, nullptr);
  return result;
}

}  // namespace inverse_dynamics_controllers
