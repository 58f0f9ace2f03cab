// SPDX-License-Identifier: Apache-2.0

/// @file
/// The fastest motion along the waypoints of a joint trajectory [inverse_dynamics_timing/retime.hpp].

#pragma once

#include <inverse_dynamics_control/payload_ramp.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_timing/retime.hpp>
#include <memory>
#include <optional>
#include <rclcpp/node.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

namespace retime {
struct Params;
}

namespace inverse_dynamics_ros {

class NodeRobot;

/// Limits for one path: one number per joint, or one for all; empty: of the parameters.
struct PathLimits {
  std::vector<double> torque, velocity, acceleration, jerk;  ///< N m, rad/s, rad/s^2, rad/s^3
};

/// An arm, its limits, and how paths are made from waypoints.
class Retiming {
 public:
  using JointTrajectory = trajectory_msgs::msg::JointTrajectory;

  /// The arm and the limits of a node's parameters, which are declared here (but for the solver's): tables
  /// `retime` and `robot` of the package's README.
  ///
  /// Without a description below the prefix, the node's parameter `robot_description` is the robot's.
  /// @param prefix  of their names, such as `ompl.retime.`.
  /// @throws  what the constructor and ParamListener throw.
  static Retiming ofNode(rclcpp::Node& node, const std::string& prefix = "");

  /// @param description  text of a URDF, of limits too; empty: none.
  /// @throws UserError, inverse_dynamics_solver::Exception: what NodeRobot::makeSolver() says; no torque limit; a
  ///   limit for another number of joints.
  Retiming(const NodeRobot& robot, const std::string& description, const retime::Params& params);

  /// A path through waypoints, of whose points only positions are read.
  ///
  /// @param deviation  rad; negative: a spline; none: the parameter's.
  /// @throws UserError  other joints, not one position per joint, a path that leaves their ranges.
  /// @throws inverse_dynamics_solver::Exception  what Path says.
  inverse_dynamics_timing::Path path(const JointTrajectory& waypoints,
                                     const std::vector<Eigen::Index>& stops = {},
                                     std::optional<double> deviation = {}) const;

  /// The limits of the parameters, and those that are given instead.
  ///
  /// @param joints  n; the order of given limits.
  /// @throws UserError  other joints.
  /// @throws inverse_dynamics_solver::Exception  another number of limits.
  inverse_dynamics_timing::MotionLimits limits(const std::vector<std::string>& joints,
                                               const PathLimits& given) const;
  const inverse_dynamics_timing::MotionLimits& limits() const { return limits_; }

  /// Positions, velocities, accelerations and efforts of the fastest motion, at the rate.
  ///
  /// @param slower  factor of the motion's duration, >= 1.
  /// @throws UserError  a path along which no motion stays within the limits.
  /// @throws inverse_dynamics_solver::Exception  what retime() says.
  JointTrajectory timed(const inverse_dynamics_timing::Path& path,
                        const inverse_dynamics_timing::MotionLimits& limits,
                        double slower = 1.0) const;

  /// Sets the body that the tip carries on following paths; mass 0: none.
  ///
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  a solver that can't.
  void carry(const inverse_dynamics_control::RigidBody& body);

  /// Name of the tip link; empty: not known.
  const std::string& tip() const { return tip_; }

 private:
  void describeLimits(const std::string& description, const retime::Params& params);
  std::vector<Eigen::Index> placesOf(const std::vector<std::string>& names) const;
  Eigen::MatrixXd pointsOf(const JointTrajectory& waypoints) const;
  void checkRanges(const inverse_dynamics_timing::Path& path) const;
  JointTrajectory sampled(const inverse_dynamics_timing::Trajectory& motion) const;

  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  inverse_dynamics_control::PayloadRamp load_;
  std::string tip_;
  std::vector<std::string> joints_;   // in trajectories
  double deviation_, rate_, margin_;  // the parameters
  inverse_dynamics_timing::MotionLimits limits_;
  Eigen::VectorXd lower_, upper_;  // rad
};

}  // namespace inverse_dynamics_ros
