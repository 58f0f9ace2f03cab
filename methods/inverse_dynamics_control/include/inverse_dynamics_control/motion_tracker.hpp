// SPDX-License-Identifier: Apache-2.0
/// @file
/// Velocities from the positions of encoders, and torques that are delayed like them.
///
///     MotionTracker tracker(n, 200.0, solver->jointTypes());   // rad/s
///     tracker.start(q);
///     tracker.update(q, period);                    // in each cycle
///     tracker.qd(), tracker.filter(torques, period);
///
/// A difference of positions that are multiples of a step has noise of the size step / period: with
/// 2^19 steps per turn at 1 kHz, 0.012 rad/s. A low-pass removes it, but delays velocities, and a
/// delayed velocity with a torque that isn't looks like an external torque whenever the arm
/// accelerates. So each joint is tracked by a model of constant acceleration, corrected by the
/// position error, with three poles at -p (a critically damped g-h-k filter [Brookner, Tracking and
/// Kalman Filtering Made Easy, 1998, sec. 1.3]):
///
///     v_tracked(s) / v(s) = (3 p^2 s + p^3) / (s + p)^3
///
/// It has no delay at constant acceleration. What is left of the torques for accelerations passes
/// through the same filter: a unit mass that the torque pushes is tracked in the same way, and the
/// force that the tracked velocity needs is the result.
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <vector>

#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Tracks n joints. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call.
class MotionTracker {
 public:
  /// @param bandwidth  p, > 0; rad/s.
  /// @param types      n: a continuous joint may be reported within one turn, its tracked position
  ///                   goes on beyond the seam; empty: no joint is continuous.
  MotionTracker(Eigen::Index joints, double bandwidth,
                std::vector<chain_dynamics::JointType> types = {});

  /// How long after start() the velocity of a joint that was moving is off by more than 0.3 % [s].
  double settlingTime() const noexcept { return 10.0 / bandwidth_; }

  /// Gain of a low-pass behind filter() such that both together rise to 1 - 1/e of a step within
  /// 1 / gain: within 2 % for gains up to 0.3 bandwidth and periods up to 2 / bandwidth. Alone with
  /// its gain the low-pass would give from 0.94 to 1.05 / gain. Beyond 0.3 bandwidth the rise takes
  /// longer, at least 1 / bandwidth.
  ///
  /// @param gain  > 0; 1/s.
  double lowPassBehind(double gain) const noexcept;

  /// How many update() it takes at least, however long the periods are: a position is known after
  /// one, a velocity after two, an acceleration after three.
  static constexpr int kSettlingUpdates = 4;

  /// Starts at a position: n, finite; rad (prismatic m).
  void start(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept;

  /// The next position.
  ///
  /// @param q       n, finite; rad (prismatic m).
  /// @param period  s since the last one, > 0.
  void update(const Eigen::Ref<const Eigen::VectorXd>& q, double period) noexcept;

  /// Tracked positions and velocities, n each.
  const OwnedVector& q() const noexcept { return q_; }
  const OwnedVector& qd() const noexcept { return qd_; }

  /// Torques as delayed as the velocities; after each update().
  ///
  /// @param torques  n, finite; means over the time since the last sample; N m (prismatic N).
  /// @param period   as of update().
  const OwnedVector& filter(const Eigen::Ref<const Eigen::VectorXd>& torques,
                            double period) noexcept;

 private:
  void chooseGains(double period) noexcept;

  double bandwidth_;
  std::vector<chain_dynamics::JointType> types_;
  double period_ = 0.0, g_ = 0.0, h_ = 0.0, k_ = 0.0;  // the gains belong to this period
  bool moving_ = false, pushed_ = false;               // whether there was an update(), a filter()
  OwnedVector q_, qd_, qdd_;                           // tracked
  OwnedVector dx_, dv_, push_;  // of the unit mass: true minus tracked position, velocity; force
  OwnedVector filtered_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
