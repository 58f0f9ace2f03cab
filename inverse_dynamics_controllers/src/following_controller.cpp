// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_controllers/following_controller.hpp"

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

CallbackReturn FollowingController::on_configure(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] { follower_ = makeFollower(); });
}

CallbackReturn FollowingController::on_activate(const rclcpp_lifecycle::State&) {
  return transition(get_node()->get_logger(), [this] {
    requireConfigured(follower_ != nullptr);
    follower_->loop().start(follower_->law(), state_interfaces_, command_interfaces_);
    follower_->input().start(follower_->loop().state().q, reference_interfaces_);
  });
}

CallbackReturn FollowingController::on_deactivate(const rclcpp_lifecycle::State&) {
  if (follower_) follower_->loop().stop(command_interfaces_);
  return CallbackReturn::SUCCESS;
}

CallbackReturn FollowingController::on_cleanup(const rclcpp_lifecycle::State&) {
  follower_.reset();
  return CallbackReturn::SUCCESS;
}

std::vector<hardware_interface::CommandInterface>
FollowingController::on_export_reference_interfaces() {
  if (!follower_) return {};
  return follower_->input().exported(get_node()->get_name(), reference_interfaces_);
}

bool FollowingController::on_set_chained_mode(bool) { return true; }

void FollowingController::readReferenceTopic() noexcept {
  if (follower_) follower_->input().readTopic(reference_interfaces_);
}

controller_interface::return_type FollowingController::update_and_write_commands(
    const rclcpp::Time&, const rclcpp::Duration& period) {
  if (!follower_) return controller_interface::return_type::ERROR;
  Follower& follower = *follower_;
  const auto update = [&](const inverse_dynamics_control::JointState& state, double dt,
                          Eigen::VectorXd& tau) {
    follower.input().advance(reference_interfaces_, is_in_chained_mode(), dt,
                             follower.loop().report());
    return follower.update(state, reference_interfaces_, dt, tau);
  };
  return follower.loop().cycle(follower.law(), state_interfaces_, command_interfaces_, period,
                               update);
}

}  // namespace inverse_dynamics_controllers
