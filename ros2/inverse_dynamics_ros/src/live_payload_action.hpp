// SPDX-License-Identifier: Apache-2.0

/// @file
/// Action of the live node that estimates the body at the tip.

#pragma once

#include <cstdint>
#include <functional>
#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_msgs/action/estimate_payload.hpp>
#include <inverse_dynamics_ros/live_node_parameters.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <string>

#include "live_payload.hpp"
#include "live_robot.hpp"
#include "live_torques.hpp"

namespace inverse_dynamics_ros {

/// ~/estimate_payload, ~/estimated_payload.
class LivePayloadAction {
 public:
  using EstimatePayload = inverse_dynamics_msgs::action::EstimatePayload;
  using RigidBody = inverse_dynamics_solver::RigidBody;

  /// @param carried  returns the body that the node lets the solver carry.
  LivePayloadAction(rclcpp::Node& node, const live_node::Params& params,
                    std::function<RigidBody()> carried);

  /// Uses this robot from now on; ends a running estimate.
  void use(const LiveRobot& robot);

  /// Takes a joint state for a running estimate.
  void take(std::int64_t stamp, const LiveTorques& live);

 private:
  using Goal = rclcpp_action::ServerGoalHandle<EstimatePayload>;
  using Result = EstimatePayload::Result;

  void accept(const std::shared_ptr<Goal>& goal);
  void step();
  void end(std::shared_ptr<Result> result);
  LivePayloadOptions options() const;
  std::shared_ptr<Result> found();

  rclcpp::Node& node_;
  live_node::Params params_;
  std::function<RigidBody()> carried_;
  LiveRobot robot_;                       // without a solver until there is one
  std::shared_ptr<Goal> goal_;            // null: no estimate is under way
  std::unique_ptr<LivePayload> payload_;  // of goal_
  std::int64_t first_ = 0, last_ = 0;     // ns; stamps of joint states for goal_; 0: none yet
  rclcpp::Publisher<geometry_msgs::msg::InertiaStamped>::SharedPtr publisher_;
  rclcpp_action::Server<EstimatePayload>::SharedPtr server_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_ros
