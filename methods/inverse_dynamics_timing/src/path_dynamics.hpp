// SPDX-License-Identifier: Apache-2.0
/// @file
/// The dynamics of a robot that can only move along a path, at the points of a grid.
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/friction_state.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <vector>

#include "inverse_dynamics_timing/retime.hpp"

namespace inverse_dynamics_timing {

using chain_dynamics::FrictionState;
using inverse_dynamics_solver::InverseDynamicsSolver;

/// Limits of each row about a squared speed: `a u + b z <= up + up_slope z`, `-(a u + b z) <= down +
/// down_slope z`.
struct Room {
  Eigen::Index k = -1;  // at this point of the grid
  double z = 0.0;       // where friction is that of the solver
  Eigen::VectorXd up, down, up_slope, down_slope;
};

/// Rows are the joints' torques, and below them, where they are limited, the joints' accelerations.
class PathDynamics {
 public:
  /// @param s         points between two stops, rising; the last is that before a stop.
  /// @param friction  what it remembers of the path before them.
  PathDynamics(const InverseDynamicsSolver& solver, const Path& path, const Eigen::VectorXd& s,
               const MotionLimits& limits, double margin, FrictionState friction);

  Eigen::Index points() const { return s_.size(); }
  Eigen::Index rows() const { return a_.rows(); }
  double s(Eigen::Index k) const { return s_[k]; }
  auto a(Eigen::Index k) const { return a_.col(k); }
  auto b(Eigen::Index k) const { return b_.col(k); }
  /// The greatest squared speed that velocities and the tip allow; may be infinite.
  double cap(Eigen::Index k) const { return cap_[k]; }

  /// Room at point k for a squared speed z >= 0; with z = 0 slopes are zero.
  void room(Eigen::Index k, double z, Room& room) const;
  Room emptyRoom() const;

  /// The joint that lacks most torque to stand still at point k, and how much; -1: none lacks any.
  Eigen::Index weakest(Eigen::Index k, double& missing) const;

 private:
  const InverseDynamicsSolver& solver_;
  const MotionLimits& limits_;
  Eigen::VectorXd s_, band_, cap_;
  Eigen::MatrixXd q_, dq_;
  Eigen::MatrixXd a_, b_, g_;
  std::vector<FrictionState> friction_;       // at each point; empty: it remembers nothing
  Eigen::MatrixXd least_still_, most_still_;  // friction at rest, n x N
};

/// Greatest excess over a limit within each interval between the points s, as a share of it, with squared
/// speeds z at the points: in its middle; at three places where the path bends; at seven, towards the
/// ends, where a joint turns back or the robot starts or stops, and friction steps.
///
/// @param s                 as of PathDynamics.
/// @param at_ends           look at the ends too: of a motion that wasn't found on this grid.
/// @param[in,out] friction  what it remembers of the path so far.
Eigen::VectorXd excess(const InverseDynamicsSolver& solver, const Path& path,
                       const Eigen::Ref<const Eigen::VectorXd>& s,
                       const Eigen::Ref<const Eigen::VectorXd>& z, const MotionLimits& limits,
                       double margin, bool at_ends, FrictionState& friction);

/// Throws unless limits and options can be used [retime.hpp].
void check(const InverseDynamicsSolver& solver, const Path& path, const MotionLimits& limits,
           const RetimeOptions& options);

}  // namespace inverse_dynamics_timing
