// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"

#include <inverse_dynamics_control/feed_forward.hpp>
#include <inverse_dynamics_controllers/feed_forward_controller_parameters.hpp>

#include "arm.hpp"
#include "control_loop.hpp"
#include "reference_input.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using inverse_dynamics_control::FeedForward;
using inverse_dynamics_control::FrictionSource;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::LawOptions;
using inverse_dynamics_control::ModelState;
using inverse_dynamics_control::Reference;
using inverse_dynamics_control::ReferenceGuard;
using inverse_dynamics_control::Status;

namespace {

// Without a motion among the references the model is asked at the measured state.
ModelState modelState(const feed_forward_controller::Params& params,
                      const ReferenceLayout& layout) {
  return params.model_state == "measured" || !layout.hasMotion() ? ModelState::kMeasured
                                                                 : ModelState::kReference;
}

void requireReferenceVelocity(const LawOptions& options, const ReferenceLayout& layout) {
  if (layout.hasMotion() || options.friction.source != FrictionSource::kReferenceVelocity) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      "parameter 'friction.source'", "no such velocity",
      "none or measured_velocity, as reference_interfaces has no velocity", "reference_velocity",
      "set one of them"));
}

}  // namespace

/// All that a configuration makes, at once or not at all.
struct FeedForwardController::Configured {
  ControlLoop loop;
  FeedForward law;
  ReferenceInput input;
  Eigen::VectorXd P, D;    // n; N m/rad, N m s/rad
  Eigen::VectorXd effort;  // scratch
  Reference at_state;      // scratch: the measured state, going on as it is

  Status update(const JointState& state, const std::vector<double>& references, double dt,
                Eigen::VectorXd& tau) noexcept {
    const bool motion = input.layout().hasMotion();
    // A stop needs feedback: own gains on a motion; else the safe torque brakes.
    const bool has_feedback = motion && (P.array() > 0).all() && (D.array() > 0).all();
    if (input.stopped() && !has_feedback) return law.hold(state, dt, tau);
    input.effort(references, effort);
    if (!motion) {
      at_state.q = state.q;
      at_state.qd = state.qd;
      return law.update(state, at_state, effort, dt, tau);
    }
    const Reference& reference = input.motion();
    effort += P.cwiseProduct(reference.q - state.q) + D.cwiseProduct(reference.qd - state.qd);
    return law.update(state, reference, effort, dt, tau);
  }
};

FeedForwardController::FeedForwardController() = default;
FeedForwardController::~FeedForwardController() = default;

controller_interface::InterfaceConfiguration
FeedForwardController::command_interface_configuration() const {
  return configured_ ? configured_->loop.interfaces().commands() : nothing();
}

controller_interface::InterfaceConfiguration FeedForwardController::state_interface_configuration()
    const {
  return configured_ ? configured_->loop.interfaces().states() : nothing();
}

CallbackReturn FeedForwardController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    parameters_ = std::make_shared<feed_forward_controller::ParamListener>(get_node());
  });
}

CallbackReturn FeedForwardController::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    const auto params = parameters_->get_params();
    const ArmParameters arm_parameters = armParameters(params);
    const Arm arm = makeArm(get_node(), arm_parameters, robotDescriptionOf(*this));
    const ReferenceLayout layout(params.reference_interfaces, arm.joints);
    const LawOptions options = lawOptions(arm, arm_parameters, get_update_rate());
    requireReferenceVelocity(options, layout);
    ReferenceGuard guard(referenceLimits(arm, params.limits),
                         jointNumbers("stop_deceleration", params.stop_deceleration, arm.joints),
                         arm.joints);
    const auto n = static_cast<Eigen::Index>(arm.joints.size());
    configured_.reset(new Configured{
        ControlLoop(get_node(), arm.joints, params.tolerated_fault_time),
        FeedForward(arm.solver, modelState(params, layout), options),
        ReferenceInput(get_node(), layout, arm.joints, guard, params.reference_timeout),
        jointNumbers("gains.p", params.gains.p, arm.joints),
        jointNumbers("gains.d", params.gains.d, arm.joints), Eigen::VectorXd::Zero(n),
        Reference(n)});
  });
}

CallbackReturn FeedForwardController::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(configured_ != nullptr);
    configured_->loop.start(configured_->law, state_interfaces_, command_interfaces_);
    configured_->input.start(configured_->loop.state().q, reference_interfaces_);
  });
}

CallbackReturn FeedForwardController::on_deactivate(const rclcpp_lifecycle::State&) {
  if (configured_) configured_->loop.stop(command_interfaces_);
  return CallbackReturn::SUCCESS;
}

CallbackReturn FeedForwardController::on_cleanup(const rclcpp_lifecycle::State&) {
  configured_.reset();
  return CallbackReturn::SUCCESS;
}

std::vector<hardware_interface::CommandInterface>
FeedForwardController::on_export_reference_interfaces() {
  if (!configured_) return {};
  return configured_->input.exported(get_node()->get_name(), reference_interfaces_);
}

bool FeedForwardController::on_set_chained_mode(bool) { return true; }

void FeedForwardController::readReferenceTopic() noexcept {
  if (configured_) configured_->input.readTopic(reference_interfaces_);
}

controller_interface::return_type FeedForwardController::update_and_write_commands(
    const rclcpp::Time&, const rclcpp::Duration& period) {
  if (!configured_) return controller_interface::return_type::ERROR;
  Configured& c = *configured_;
  const auto update = [&](const JointState& state, double dt, Eigen::VectorXd& tau) {
    c.input.advance(reference_interfaces_, is_in_chained_mode(), dt, c.loop.report());
    return c.update(state, reference_interfaces_, dt, tau);
  };
  return c.loop.cycle(c.law, state_interfaces_, command_interfaces_, period, update);
}

}  // namespace inverse_dynamics_controllers
