// SPDX-License-Identifier: Apache-2.0
/// @file
/// The state of a controller on its topic ~/controller_state.
///
/// The message is a joint_trajectory_controller's, so that the same tools show it: reference,
/// feedback, error, and efforts as output.
#pragma once

#include <chain_dynamics/chain.hpp>
#include <inverse_dynamics_control/signals.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// Hands the newest cycle to another thread without a lock, which publishes it.
class StatePublisher {
 public:
  /// @param types  n; errors of continuous joints take the short way.
  /// @param rate   messages per second; 0: none, and no topic.
  StatePublisher(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                 const std::vector<std::string>& joints,
                 const std::vector<chain_dynamics::JointType>& types, double rate);

  /// A cycle's numbers; n each. Real time: no allocation, lock, exception or system call.
  ///
  /// @param reference  what was followed; null: nothing.
  void note(const rclcpp::Time& time, const inverse_dynamics_control::JointState& state,
            const inverse_dynamics_control::Reference* reference,
            const Eigen::VectorXd& tau) noexcept;

 private:
  struct Outbox;

  std::shared_ptr<Outbox> outbox_;  // null: nothing is published
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_controllers
