// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/following_controller.hpp"

#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_controllers/reference_parameters.hpp>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "arm.hpp"
#include "follower.hpp"

namespace inverse_dynamics_controllers {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;

FollowingController::FollowingController() = default;
FollowingController::~FollowingController() = default;

InterfaceConfiguration FollowingController::command_interface_configuration() const {
  return follower_ ? follower_->loop().interfaces().commands() : nothing();
}

InterfaceConfiguration FollowingController::state_interface_configuration() const {
  return follower_ ? follower_->loop().interfaces().states() : nothing();
}

CallbackReturn FollowingController::on_init() {
  return transition(get_node()->get_logger(), [this] {
    arm_source_ = std::make_unique<ArmSource>(get_node(), ArmSource::Use::kCommand);
    reference_parameters_ = std::make_shared<reference_parameters::ParamListener>(get_node());
    make_follower_ = declareParameters();
  });
}

CallbackReturn FollowingController::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    follower_ = make_follower_(arm_source_->setup(robotDescriptionOf(*this), get_update_rate()),
                               reference_parameters_->get_params());
    references_.assign(referenceNames().size(), std::numeric_limits<double>::quiet_NaN());
  });
}

CallbackReturn FollowingController::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(follower_ != nullptr);
    follower_->loop().start(follower_->law(), state_interfaces_, command_interfaces_, false);
    forgetReferences();
    follower_->input().start(follower_->loop().state(), references_);
  });
}

CallbackReturn FollowingController::on_deactivate(const rclcpp_lifecycle::State&) {
  if (follower_) follower_->loop().stop(follower_->law(), state_interfaces_, command_interfaces_);
  return CallbackReturn::SUCCESS;
}

CallbackReturn FollowingController::on_cleanup(const rclcpp_lifecycle::State&) {
  follower_.reset();
  return CallbackReturn::SUCCESS;
}

std::vector<std::string> FollowingController::referenceNames() const {
  return follower_ ? follower_->input().layout().names() : std::vector<std::string>();
}

bool FollowingController::on_set_chained_mode(bool) { return true; }

void FollowingController::readReferenceTopic() noexcept {
  if (follower_) follower_->input().readTopic(references_);
}

controller_interface::return_type FollowingController::update_and_write_commands(
    const rclcpp::Time& time, const rclcpp::Duration& period) {
  if (!follower_) return controller_interface::return_type::ERROR;
  Follower& follower = *follower_;
  const bool chained = is_in_chained_mode();
  if (chained) readReferences(references_);
  const auto update = [&](const inverse_dynamics_control::JointState& state, double dt,
                          Eigen::VectorXd& tau) {
    follower.input().advance(references_, chained, state, dt, follower.loop().report());
    return follower.update(state, references_, dt, tau);
  };
  const auto result =
      follower.loop().cycle(follower.law(), state_interfaces_, command_interfaces_, period, update);
  follower.loop().publish(time, follower.input().motion());
  return result;
}

}  // namespace inverse_dynamics_controllers
