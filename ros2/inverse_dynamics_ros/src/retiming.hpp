// SPDX-License-Identifier: Apache-2.0

/// @file
/// The fastest motion along the waypoints of a joint trajectory [inverse_dynamics_timing/retime.hpp].

#pragma once

#include <inverse_dynamics_control/payload_ramp.hpp>
#include <inverse_dynamics_ros/retime_parameters.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_timing/retime.hpp>
#include <memory>
#include <optional>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

#include "robot_parameters.hpp"

namespace inverse_dynamics_ros {

/// Options of one path [inverse_dynamics_msgs/srv/Retime.srv].
struct PathOptions {
  std::vector<Eigen::Index> stops;  ///< waypoints, from 0
  std::optional<double> deviation;  ///< rad; none: the parameter's
  double slower = 1.0;              ///< factor of the motion's duration, >= 1
};

/// An arm, its limits, and how paths are made from waypoints.
class Retiming {
 public:
  using JointTrajectory = trajectory_msgs::msg::JointTrajectory;

  /// @param description  text of a URDF, of limits too; empty: none.
  /// @throws UserError, inverse_dynamics_solver::Exception: what NodeRobot::makeSolver() says; no torque limit; a
  ///   limit for another number of joints.
  Retiming(const NodeRobot& robot, const std::string& description, const retime::Params& params);

  /// Positions, velocities, accelerations and efforts at the rate, with the header of the path.
  ///
  /// @param path  at least two different waypoints; of its points only positions are read.
  /// @throws UserError  other joints, not one position per joint, a path that leaves the ranges of the joints,
  ///   or that can't be held, a motion that is to be faster.
  /// @throws inverse_dynamics_solver::Exception  what retime() and Path say.
  JointTrajectory timed(const JointTrajectory& path, const PathOptions& options = {}) const;

  /// Sets the body that the tip carries on following paths; mass 0: none.
  ///
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  a solver that can't.
  void carry(const inverse_dynamics_control::RigidBody& body);

  /// Name of the tip link; empty: not known.
  const std::string& tip() const { return tip_; }

 private:
  void describeLimits(const std::string& description);
  Eigen::MatrixXd waypoints(const JointTrajectory& path) const;
  void checkRanges(const inverse_dynamics_timing::Path& path) const;
  JointTrajectory sampled(const inverse_dynamics_timing::Trajectory& motion) const;

  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver_;
  inverse_dynamics_control::PayloadRamp load_;
  std::string tip_;
  std::vector<std::string> joints_;  // in trajectories
  retime::Params params_;
  inverse_dynamics_timing::MotionLimits limits_;
  Eigen::VectorXd lower_, upper_;  // rad
};

}  // namespace inverse_dynamics_ros
