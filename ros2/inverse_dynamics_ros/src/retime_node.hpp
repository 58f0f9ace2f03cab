// SPDX-License-Identifier: Apache-2.0

/// @file
/// The node `retime`: the service `retime` of type inverse_dynamics_msgs/srv/Retime answers a path with the
/// fastest motion along it within the torque limits of the joints.

#pragma once

#include <exception>
#include <inverse_dynamics_msgs/srv/retime.hpp>
#include <inverse_dynamics_ros/retiming.hpp>
#include <inverse_dynamics_solver/strict_initialization.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_parameters.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {

class RetimeNode : public rclcpp::Node {
 public:
  using Retime = inverse_dynamics_msgs::srv::Retime;

  explicit RetimeNode(const rclcpp::NodeOptions& options)
      : rclcpp::Node("retime", options),
        retiming_((declareRobotParameters(*this), Retiming::ofNode(*this))) {
    inverse_dynamics_solver::rejectUndeclared(*get_node_parameters_interface());
    service_ = create_service<Retime>(
        // NOLINTNEXTLINE(performance-unnecessary-value-param): the type that rclcpp asks for
        "retime", [this](const Retime::Request::SharedPtr q, const Retime::Response::SharedPtr r) {
          answer(*q, *r);
        });
  }

 private:
  void answer(const Retime::Request& request, Retime::Response& response) {
    response.ignored = ignored(request.path);
    try {
      response.error_code = Retime::Response::INVALID_REQUEST;
      retiming_.carry(inverse_dynamics_control::bodyOf(request.payload, retiming_.tip()));
      const double slower = 1 / share(request.velocity_scaling_factor);
      const auto deviation = deviationOf(request);
      response.error_code = Retime::Response::INVALID_PATH;
      const auto path =
          retiming_.path(request.path, {request.stops.begin(), request.stops.end()}, deviation);
      response.error_code = Retime::Response::INVALID_REQUEST;
      const auto limits = retiming_.limits(request.path.joint_names,
                                           {request.torque_limits, request.velocity_limits,
                                            request.acceleration_limits, request.jerk_limits});
      response.error_code = Retime::Response::INFEASIBLE;
      response.trajectory = retiming_.timed(path, limits, slower);
      response.trajectory.header = request.path.header;
      response.error_code = Retime::Response::SUCCESSFUL;
    } catch (const std::exception& error) {
      response.message = error.what();
      RCLCPP_WARN(get_logger(), "%s", error.what());
    }
  }

  static double share(double factor) {
    if (factor > 0 && factor <= 1) return factor;
    throw UserError("velocity_scaling_factor", "a number above 0, at most 1",
                    std::to_string(factor), "limits of velocity are velocity_limits");
  }

  static std::optional<double> deviationOf(const Retime::Request& request) {
    if (request.shape == Retime::Request::OF_NODE) return {};
    if (request.shape == Retime::Request::SPLINE) return -1.0;
    if (request.shape == Retime::Request::LINES && request.deviation >= 0) return request.deviation;
    throw UserError("shape", "OF_NODE (0), SPLINE (1), or LINES (2) and a deviation of at least 0",
                    std::to_string(request.shape) + " and " + std::to_string(request.deviation),
                    "correct them");
  }

  // Fields of the points that are there but not read.
  static std::vector<std::string> ignored(const trajectory_msgs::msg::JointTrajectory& path) {
    bool velocities = false, accelerations = false, effort = false, times = false;
    for (const auto& point : path.points) {
      velocities |= !point.velocities.empty();
      accelerations |= !point.accelerations.empty();
      effort |= !point.effort.empty();
      times |= rclcpp::Duration(point.time_from_start).nanoseconds() != 0;
    }
    std::vector<std::string> names;
    for (const auto& [given, name] :
         {std::pair(velocities, "velocities"), std::pair(accelerations, "accelerations"),
          std::pair(effort, "effort"), std::pair(times, "time_from_start")}) {
      if (given) names.emplace_back(name);
    }
    return names;
  }

  Retiming retiming_;
  rclcpp::Service<Retime>::SharedPtr service_;
};

}  // namespace inverse_dynamics_ros
