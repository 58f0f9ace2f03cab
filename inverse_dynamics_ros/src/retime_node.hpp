// SPDX-License-Identifier: Apache-2.0

/// @file
/// The node `retime`: the fastest motion along a path within the torque limits of the joints.
///
/// | topic        | type                                | |
/// |--------------|-------------------------------------|-----------------------------------------------|
/// | ~/path       | trajectory_msgs/msg/JointTrajectory | in: waypoints; times are ignored              |
/// | ~/trajectory | trajectory_msgs/msg/JointTrajectory | out: timed, with efforts; no points: refused  |
///
/// Each path is answered once, with its header.

#pragma once

#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "node_solver.hpp"
#include "retiming.hpp"

namespace inverse_dynamics_ros {

class RetimeNode : public rclcpp::Node {
 public:
  using JointTrajectory = Retiming::JointTrajectory;

  explicit RetimeNode(const rclcpp::NodeOptions& options)
      : rclcpp::Node("retime", options),
        listener_((declareSolverParameters(*this), get_node_parameters_interface()), get_logger()),
        retiming_(make(NodeRobot(givenParameters(*this)))) {
    inverse_dynamics_solver::rejectUndeclared(*get_node_parameters_interface());
    answers_ = create_publisher<JointTrajectory>("~/trajectory", rclcpp::QoS(10));
    paths_ = create_subscription<JointTrajectory>(
        "~/path", rclcpp::QoS(10),
        [this](const JointTrajectory& path) { answers_->publish(answer(path)); });
  }

 private:
  Retiming make(const NodeRobot& robot) const {
    return Retiming(robot, robot.description(), listener_.get_params());
  }

  JointTrajectory answer(const JointTrajectory& path) const {
    try {
      return retiming_.timed(path);
    } catch (const std::exception& error) {
      RCLCPP_ERROR(get_logger(), "%s", error.what());
    }
    JointTrajectory refused;
    refused.header = path.header;
    refused.joint_names = path.joint_names;
    return refused;
  }

  retime::ParamListener listener_;
  Retiming retiming_;
  rclcpp::Publisher<JointTrajectory>::SharedPtr answers_;
  rclcpp::Subscription<JointTrajectory>::SharedPtr paths_;
};

}  // namespace inverse_dynamics_ros
