// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimates of what touches the robot, on topics.
///
///     WrenchPublisher publisher(node, joints, "tool0", 50.0);
///     publisher.note(time, sensed);                      // in each cycle that has an estimate
#pragma once

#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

#include "sensed_wrench.hpp"

namespace inverse_dynamics_controllers {

/// Hands the newest estimate to another thread without a lock, which publishes it.
///
/// Topics: ~/wrench (what the surroundings exert on the tip), ~/external_torques (what the robot
/// exerts on its surroundings, as `effort`), ~/contact.
class WrenchPublisher {
 public:
  /// @param frame     of the wrench.
  /// @param rate      messages per second; 0: none, and no topic.
  /// @param contacts  whether there is a topic ~/contact.
  WrenchPublisher(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                  const std::vector<std::string>& joints, const std::string& frame, double rate,
                  bool contacts);

  /// An estimate. Real time: no allocation, lock, exception or system call.
  void note(const rclcpp::Time& time, const SensedWrench& sensed) noexcept;

 private:
  struct Outbox;

  std::shared_ptr<Outbox> outbox_;  // null: nothing is published
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_controllers
