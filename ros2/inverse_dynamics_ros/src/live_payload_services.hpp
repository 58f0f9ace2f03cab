// SPDX-License-Identifier: Apache-2.0

/// @file
/// Services of the live node that estimate the body at the tip.

#pragma once

#include <cstdint>
#include <functional>
#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_ros/live_node_parameters.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "live_payload.hpp"
#include "live_robot.hpp"
#include "live_torques.hpp"

namespace inverse_dynamics_ros {

/// ~/estimate_payload/start, ~/estimate_payload/stop, ~/estimated_payload.
class LivePayloadServices {
 public:
  using Trigger = std_srvs::srv::Trigger;
  using RigidBody = inverse_dynamics_solver::RigidBody;

  /// @param carried  returns the body that the node lets the solver carry.
  LivePayloadServices(rclcpp::Node& node, const live_node::Params& params,
                      std::function<RigidBody()> carried);

  /// Uses this robot from now on; discards a running estimate.
  void use(const LiveRobot& robot);

  /// Takes a joint state for a running estimate.
  void take(std::int64_t stamp, const LiveTorques& live);

 private:
  void start(Trigger::Response& response);
  void stop(Trigger::Response& response);
  LivePayloadOptions options() const;
  void publish(const RigidBody& body);

  rclcpp::Node& node_;
  live_node::Params params_;
  std::function<RigidBody()> carried_;
  LiveRobot robot_;                       // without a solver until there is one
  std::unique_ptr<LivePayload> payload_;  // null: no estimate is under way
  rclcpp::Publisher<geometry_msgs::msg::InertiaStamped>::SharedPtr publisher_;
  rclcpp::Service<Trigger>::SharedPtr start_, stop_;
};

}  // namespace inverse_dynamics_ros
