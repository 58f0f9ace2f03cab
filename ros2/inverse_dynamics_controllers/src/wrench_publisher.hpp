// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimates of what touches the robot, on topics.
#pragma once

#include <array>
#include <inverse_dynamics_control/contact_sensing.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// What the surroundings exert **on the tip**, as sensors of ros2_control have it: force [N], then
/// torque [N m] about the origin of the tip, in the axes of the tip.
std::array<double, 6> sensorWrench(
    const inverse_dynamics_control::ContactSensing& sensing) noexcept;

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
  void note(const rclcpp::Time& time,
            const inverse_dynamics_control::ContactSensing& sensing) noexcept;

 private:
  struct Outbox;

  std::shared_ptr<Outbox> outbox_;  // null: nothing is published
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_controllers
