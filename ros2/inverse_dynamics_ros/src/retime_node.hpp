// SPDX-License-Identifier: Apache-2.0

/// @file
/// The node `retime`: the service `retime` of type inverse_dynamics_msgs/srv/Retime answers a path with the
/// fastest motion along it within the torque limits of the joints.

#pragma once

#include <exception>
#include <inverse_dynamics_msgs/srv/retime.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <rclcpp/rclcpp.hpp>

#include "retiming.hpp"
#include "robot_parameters.hpp"

namespace inverse_dynamics_ros {

class RetimeNode : public rclcpp::Node {
 public:
  using Retime = inverse_dynamics_msgs::srv::Retime;

  explicit RetimeNode(const rclcpp::NodeOptions& options)
      : rclcpp::Node("retime", options),
        listener_((declareRobotParameters(*this), get_node_parameters_interface()), get_logger()),
        retiming_(make(NodeRobot(givenParameters(*this)))) {
    inverse_dynamics_solver::rejectUndeclared(*get_node_parameters_interface());
    service_ = create_service<Retime>(
        // NOLINTNEXTLINE(performance-unnecessary-value-param): the type that rclcpp asks for
        "retime", [this](const Retime::Request::SharedPtr q, const Retime::Response::SharedPtr r) {
          answer(*q, *r);
        });
  }

 private:
  Retiming make(const NodeRobot& robot) const {
    return Retiming(robot, robot.description(), listener_.get_params());
  }

  void answer(const Retime::Request& request, Retime::Response& response) {
    try {
      PathOptions options;
      options.stops.assign(request.stops.begin(), request.stops.end());
      if (!request.deviation.empty()) options.deviation = request.deviation.front();
      options.slower = request.slower;
      retiming_.carry(inverse_dynamics_control::bodyOf(request.payload, retiming_.tip()));
      response.trajectory = retiming_.timed(request.path, options);
      response.success = true;
    } catch (const std::exception& error) {
      response.message = error.what();
      RCLCPP_WARN(get_logger(), "%s", error.what());
    }
  }

  retime::ParamListener listener_;
  Retiming retiming_;
  rclcpp::Service<Retime>::SharedPtr service_;
};

}  // namespace inverse_dynamics_ros
