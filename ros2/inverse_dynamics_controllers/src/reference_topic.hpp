// SPDX-License-Identifier: Apache-2.0
/// @file
/// References from a topic, for a chainable controller that nothing precedes.
///
/// A message is a trajectory_msgs/msg/JointTrajectory with exactly one point: the reference from
/// now on. What doesn't fit, or has the stamp of another time, is reported and ignored.
#pragma once

#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

#include "reference_layout.hpp"

namespace inverse_dynamics_controllers {

/// The numbers of a message, in the order of the layout.
///
/// Velocities are needed with positions; accelerations that are left out are zero.
/// @param[out] values  layout.size() numbers; unchanged if the message doesn't fit.
/// @return what is wrong with the message; empty: nothing.
std::string referencesOf(const trajectory_msgs::msg::JointTrajectory& message,
                         const ReferenceLayout& layout, const std::vector<std::string>& joints,
                         std::vector<double>& values);

/// Subscribes to ~/reference, and hands the newest numbers to the control loop without a lock.
class ReferenceTopic {
 public:
  /// @param oldest  how far from now a stamp may be [s]; a stamp of zero means now.
  ReferenceTopic(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                 const ReferenceLayout& layout, const std::vector<std::string>& joints,
                 double oldest);

  /// Copies the newest references, if there are new ones. Real time: no allocation, lock, exception
  /// or system call.
  bool read(std::vector<double>& values) noexcept;

 private:
  struct Inbox;

  std::shared_ptr<Inbox> inbox_;  // a message that is being received keeps it
  rclcpp::Subscription<trajectory_msgs::msg::JointTrajectory>::SharedPtr subscription_;
};

}  // namespace inverse_dynamics_controllers
