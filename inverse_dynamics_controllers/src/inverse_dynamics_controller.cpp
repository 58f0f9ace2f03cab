// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"

#include <inverse_dynamics_control/computed_torque.hpp>
#include <inverse_dynamics_controllers/inverse_dynamics_controller_parameters.hpp>

#include "arm.hpp"
#include "control_loop.hpp"
#include "reference_input.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using inverse_dynamics_control::ComputedTorque;
using inverse_dynamics_control::Gains;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::ReferenceGuard;
using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;

namespace {

// Errors go through H: a negative diagonal entry would make that joint's feedback positive.
void requirePhysicalInertia(const Arm& arm, const std::string& plugin_name) {
  if (arm.solver->inertiaIsPhysical()) return;
  throw InvalidParameterValueException(
      errorText("parameter 'plugin_name'", "not fit for computed torque",
                "a solver whose inertia matrix is symmetric and positive definite",
                plugin_name + ", whose inertiaIsPhysical() is false",
                "use inverse_dynamics_controllers/FeedForwardController with it, or here a solver "
                "made from the robot's URDF"));
}

Gains gainsOf(const inverse_dynamics_controller::Params& params, const Arm& arm) {
  if (params.gains.natural_frequency.empty()) {
    throw inverse_dynamics_solver::ParameterUninitializedException(
        errorText("parameter 'gains.natural_frequency'", "not set", "numbers above zero [rad/s]",
                  "nothing", "start with 10 and double it while the arm is quiet"));
  }
  return Gains::of(
      jointNumbers("gains.natural_frequency", params.gains.natural_frequency, arm.joints),
      jointNumbers("gains.damping_ratio", params.gains.damping_ratio, arm.joints));
}

}  // namespace

/// All that a configuration makes, at once or not at all.
struct InverseDynamicsController::Configured {
  ControlLoop loop;
  ComputedTorque law;
  ReferenceInput input;
};

InverseDynamicsController::InverseDynamicsController() = default;
InverseDynamicsController::~InverseDynamicsController() = default;

controller_interface::InterfaceConfiguration
InverseDynamicsController::command_interface_configuration() const {
  return configured_ ? configured_->loop.interfaces().commands() : nothing();
}

controller_interface::InterfaceConfiguration
InverseDynamicsController::state_interface_configuration() const {
  return configured_ ? configured_->loop.interfaces().states() : nothing();
}

CallbackReturn InverseDynamicsController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    parameters_ = std::make_shared<inverse_dynamics_controller::ParamListener>(get_node());
  });
}

CallbackReturn InverseDynamicsController::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    const auto params = parameters_->get_params();
    const ArmParameters arm_parameters = armParameters(params);
    const Arm arm = makeArm(get_node(), arm_parameters, robotDescriptionOf(*this));
    requirePhysicalInertia(arm, params.plugin_name);
    ReferenceGuard guard(referenceLimits(arm, params.limits),
                         jointNumbers("stop_deceleration", params.stop_deceleration, arm.joints),
                         arm.joints);
    configured_.reset(new Configured{
        ControlLoop(get_node(), arm.joints, params.tolerated_fault_time),
        ComputedTorque(arm.solver, gainsOf(params, arm),
                       lawOptions(arm, arm_parameters, get_update_rate())),
        ReferenceInput(get_node(), ReferenceLayout(params.reference_interfaces, arm.joints),
                       arm.joints, guard, params.reference_timeout)});
  });
}

CallbackReturn InverseDynamicsController::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(configured_ != nullptr);
    configured_->loop.start(configured_->law, state_interfaces_, command_interfaces_);
    configured_->input.start(configured_->loop.state().q, reference_interfaces_);
  });
}

CallbackReturn InverseDynamicsController::on_deactivate(const rclcpp_lifecycle::State&) {
  if (configured_) configured_->loop.stop(command_interfaces_);
  return CallbackReturn::SUCCESS;
}

CallbackReturn InverseDynamicsController::on_cleanup(const rclcpp_lifecycle::State&) {
  configured_.reset();
  return CallbackReturn::SUCCESS;
}

std::vector<hardware_interface::CommandInterface>
InverseDynamicsController::on_export_reference_interfaces() {
  if (!configured_) return {};
  return configured_->input.exported(get_node()->get_name(), reference_interfaces_);
}

bool InverseDynamicsController::on_set_chained_mode(bool) { return true; }

void InverseDynamicsController::readReferenceTopic() noexcept {
  if (configured_) configured_->input.readTopic(reference_interfaces_);
}

controller_interface::return_type InverseDynamicsController::update_and_write_commands(
    const rclcpp::Time&, const rclcpp::Duration& period) {
  if (!configured_) return controller_interface::return_type::ERROR;
  auto& [loop, law, input] = *configured_;
  const auto update = [&](const JointState& state, double dt, Eigen::VectorXd& tau) {
    input.advance(reference_interfaces_, is_in_chained_mode(), dt, loop.report());
    return law.update(state, input.motion(), dt, tau);
  };
  return loop.cycle(law, state_interfaces_, command_interfaces_, period, update);
}

}  // namespace inverse_dynamics_controllers
