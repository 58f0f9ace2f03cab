// SPDX-License-Identifier: Apache-2.0
/// @file
/// The fastest motion along a path within the limits of the joints.
///
///     MotionLimits limits;
///     limits.torque = Eigen::VectorXd::Constant(6, 50.0);
///     const Retimed fastest = retime(*solver, Path::lines(waypoints, 0.05), limits);
///     if (!fastest) throw std::runtime_error(text(fastest.refusal, solver->jointNames()));
///     fastest.trajectory.evaluate(t, q, qd, qdd);
///
/// **Method.** Along a path `q(s)` all torques follow from the squared speed `z = s'^2` of its
/// parameter and from its acceleration u,
///
///     tau = a(s) u + b(s) z + g(s) + f(s, z),
///
/// `a = H q'`, `b = H q'' + C(q, q') q'`, gravity g, friction f. On a grid over s with constant u in
/// each interval, a backward pass finds the greatest z at each point from which the end can be
/// reached, a forward pass takes the greatest acceleration that stays below [reachability analysis:
/// Pham, Pham 2018, doi 10.1109/TRO.2018.2819195]. Limits hold at both ends of each interval. Friction
/// isn't linear in z: each step solves its linear program again with friction at the solution, until
/// nothing changes, so friction there is exact.
///
/// What friction remembers follows from the path up to what the motion before left
/// [chain_dynamics/friction_state.hpp]; limits hold for all that this may be.
///
/// Where friction falls with speed (Stribeck), the speeds from which the end is reached may not be one
/// interval; they are taken for one.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <limits>
#include <string>
#include <vector>

#include "chain_dynamics/owned.hpp"
#include "inverse_dynamics_timing/path.hpp"
#include "inverse_dynamics_timing/trajectory.hpp"

namespace inverse_dynamics_timing {
inline namespace v2 {

/// Limits of the joints' sizes, both directions; n numbers > 0 each, or none: unlimited.
struct MotionLimits {
  chain_dynamics::OwnedVector torque;        ///< N m (sliders: N); required
  chain_dynamics::OwnedVector velocity;      ///< rad/s
  chain_dynamics::OwnedVector acceleration;  ///< rad/s^2
  /// rad/s^3, of `qdd` over 1 ms; start and end must be at rest. The speed of a motion with limited
  /// acceleration is averaged over a span of time; the acceleration is the best for it, not an optimum of
  /// all motions.
  chain_dynamics::OwnedVector jerk;
  /// N m/s, of the torque over 1 ms, friction included; kept as limits of jerk are.
  chain_dynamics::OwnedVector torque_rate;

  /// @name Motors whose torque falls with speed
  /// The torque limit falls in a line from `torque` at `knee_velocity` to zero at
  /// `no_load_velocity`, rad/s. Both or none.
  /// @{
  chain_dynamics::OwnedVector knee_velocity;
  chain_dynamics::OwnedVector no_load_velocity;
  /// @}

  double tip_speed = std::numeric_limits<double>::infinity();  ///< of each tip's origin, m/s
};

struct RetimeOptions {
  Eigen::Index points = 1000;  ///< of the grid, about; there are more where the path bends
  double start_speed = 0.0;    ///< ds/dt at the path's start, >= 0
  double end_speed = 0.0;      ///< at its end
  /// Share of the measured torques that shall be within the limits, for solvers whose model states
  /// how far they are from the computed ones [torque_deviation.hpp]: 0.95 leaves a band of 95 % free
  /// below each limit. 0: the computed torque itself may reach the limit.
  double margin = 0.0;
};

/// Why there is no motion.
struct Refusal {
  enum class Reason {
    kNone,
    kTorqueAtRest,  ///< a joint can't hold the robot at `s`, where it rests, or where no speed helps
    kNoWayOn,       ///< each speed at `s` leads where limits can't be kept
    kStartTooFast,  ///< the start's speed is beyond what limits allow
    kEndTooFast,    ///< the end's speed is
    kTooSlow,       ///< with limits of jerk or of the torque's rate, a motion longer than 600 s
    kRateTooLow,    ///< a joint's torque changes faster than its limit, however slow the motion is
  };
  Reason reason = Reason::kNone;
  double s = 0.0;           ///< where, parameter of the path
  Eigen::Index joint = -1;  ///< which joint lacks torque
  /// How much, N m; of speeds the greatest possible one, ds/dt; kTooSlow: the duration, s; kRateTooLow:
  /// the rate, N m/s.
  double missing = 0.0;
};

/// Text of a refusal, with the joint's name; empty: none.
std::string text(const Refusal& refusal, const std::vector<std::string>& joint_names);

struct Retimed {
  Trajectory trajectory;  ///< empty where refused
  Refusal refusal;

  explicit operator bool() const { return refusal.reason == Refusal::Reason::kNone; }
};

/// The fastest motion along a path.
///
/// Real time: no; memory grows linearly with points. Threads: safe, many paths may be timed with one
/// solver at once.
///
/// @throws inverse_dynamics_solver::SizeMismatchException           path or a limit of another size.
/// @throws inverse_dynamics_solver::InvalidParameterValueException  a limit that isn't > 0, no torque
///   limit, options out of range, a margin for a model that states no deviation, a tip speed for a
///   solver without kinematics.
Retimed retime(const inverse_dynamics_solver::InverseDynamicsSolver& solver, const Path& path,
               const MotionLimits& limits, const RetimeOptions& options = {});

/// Half the width of the band about computed torques that holds a share of the measured ones, n, N m
/// (sliders: N): what a margin leaves free. 0: zeros.
///
/// @throws inverse_dynamics_solver::InvalidParameterValueException  the margin isn't a share below 1, or
///   the model states no deviation.
chain_dynamics::OwnedVector torqueBand(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                                       double margin);

/// The greatest speed ds/dt at which limits can be kept for an instant, at each point of a
/// trajectory's grid: what its speed is compared with. NaN where there is none.
chain_dynamics::OwnedVector speedLimit(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                                       const Trajectory& trajectory, const MotionLimits& limits,
                                       const RetimeOptions& options = {});

}  // namespace v2
}  // namespace inverse_dynamics_timing
