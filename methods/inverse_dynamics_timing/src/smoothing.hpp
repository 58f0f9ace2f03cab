// SPDX-License-Identifier: Apache-2.0
/// @file
/// Motions whose accelerations don't jump: with limits of jerk and of the torques' rates.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>

#include "inverse_dynamics_timing/retime.hpp"

namespace inverse_dynamics_timing {

/// The fastest change of a joint's acceleration or torque over 1 ms.
struct Change {
  double share = 0.0;       ///< of its limit
  double s = 0.0;           ///< where
  Eigen::Index joint = -1;  ///< whose torque; -1: an acceleration
};

/// The motion with its speed averaged over a span of time, which is as short as limits of jerk and of
/// the torques' rates allow, and then slowed where the path's own bends need it.
///
/// The path stays the same. Averaged states lie between those of the motion, so its torques pass their
/// limits only as far as H, C and g change within the span.
///
/// @param jerk          n, > 0, rad/s^3: about what both kinds of limits allow.
/// @param longest       s; longer motions aren't smoothed further.
/// @param[out] fastest  change of the result; its share is above 1 where no slower motion keeps the limit,
///   or where it would be too long.
Trajectory smoothed(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const Trajectory& motion, const MotionLimits& limits,
                    const Eigen::VectorXd& jerk, double longest, Change& fastest);

/// The fastest change of a motion; of one whose intervals differ in length, or are of more than 1 ms, at
/// most that much.
Change fastestChange(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                     const Trajectory& motion, const MotionLimits& limits);

/// The time in which the joints reach the motion's greatest accelerations with these jerks, s.
double accelerationTime(const Trajectory& motion, const Eigen::VectorXd& jerk);

}  // namespace inverse_dynamics_timing
