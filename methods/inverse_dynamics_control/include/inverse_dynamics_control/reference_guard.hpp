// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which reference a law follows: the desired one while it is sound, else a stop that lasts.
///
///     ReferenceGuard guard(limits, deceleration, solver->jointNames(), solver->jointTypes());
///     guard.start(state.q);                                       // when the loop begins
///     const Reference& reference = guard.next(desired, period);    // in each cycle
///     if (guard.stopped()) report(text(guard.reason()));
///
/// A law answers to a NaN with its safe torque and then follows the next finite reference, from
/// wherever the arm is by then. A guard precedes it: the first reference that isn't finite, lies
/// beyond a limit, or steps farther than the limits allow begins a SafeStop from the last good one,
/// and nothing is followed any more until start().
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_control/safe_stop.hpp"
#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Limits of a reference, n numbers each; infinity: no limit.
///
/// Velocities and accelerations may pass theirs by 0.5 %, as motions do that were timed within them.
struct ReferenceLimits {
  OwnedVector lower;         ///< rad (prismatic m)
  OwnedVector upper;         ///< rad (prismatic m), not below `lower`
  OwnedVector velocity;      ///< > 0; rad/s (prismatic m/s)
  OwnedVector acceleration;  ///< of speeding up, > 0; rad/s^2 (prismatic m/s^2)
  OwnedVector deceleration;  ///< of slowing down, likewise

  /// No limit at all.
  static ReferenceLimits none(Eigen::Index joints);
};

/// Why a reference is followed no longer.
enum class StopReason {
  kNone,          ///< it is followed
  kNotFinite,     ///< a number of it is NaN or infinite
  kPosition,      ///< a position lies beyond its limits
  kVelocity,      ///< a velocity lies beyond its limit
  kAcceleration,  ///< an acceleration lies beyond its limit
  kStep,          ///< it is farther from the last one than velocity and acceleration limits allow
  kStale,         ///< no new one came while the last one still moves
  kWrongSize,     ///< it hasn't one number per joint
};

/// Text of a message, without a full stop. Real time: no allocation, lock, exception or
/// system call. Threads: safe.
const char* text(StopReason reason) noexcept;

/// What becomes of a reference that is too far from the last one.
enum class Steps {
  kRefuse,  ///< a stop
  kRamp,    ///< the guard moves there, within the velocity limits, with the stop's deceleration
};

/// Lets sound references pass, and stops for good at the first one that isn't. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call.
class ReferenceGuard {
 public:
  /// @param deceleration  of the stop, n, finite, > 0; rad/s^2 (prismatic m/s^2).
  /// @param joint_names   n of them, for the text of errors.
  /// @param joint_types   n: position limits of continuous joints hold for any whole turns of the
  ///                      reference, if they are no more than a turn apart; empty: no joint is
  ///                      continuous.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value.
  ReferenceGuard(ReferenceLimits limits, const Eigen::Ref<const Eigen::VectorXd>& deceleration,
                 const std::vector<std::string>& joint_names,
                 std::vector<chain_dynamics::JointType> joint_types = {},
                 Steps steps = Steps::kRefuse);

  /// Until the first call of next(), the reference stops from q and qd, n finite numbers each; rest
  /// without qd. Forgets an earlier stop.
  void start(const Eigen::Ref<const Eigen::VectorXd>& q,
             const Eigen::Ref<const Eigen::VectorXd>& qd) noexcept;
  /// @copydoc start()
  void start(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept {
    followed_.qd.setZero();
    start(q, followed_.qd);
  }

  /// The reference to follow now: `desired`, or the next one of the stop or of the ramp.
  ///
  /// A position may be as far from the last one as the velocity limit allows in the interval and one
  /// period more, as cycles jitter; a velocity, as the acceleration limit allows. Both may come nearer to the
  /// measured state than the last reference: another motion may begin where the arm is.
  ///
  /// @param period    s since the last call.
  /// @param interval  s since the reference before `desired`; `period` where each cycle has its own.
  /// @param measured  n each; what isn't finite doesn't count.
  const Reference& next(const Reference& desired, double period, double interval,
                        const JointState& measured) noexcept;

  /// The same where each cycle has its own reference, without a measured state.
  const Reference& next(const Reference& desired, double period) noexcept {
    return next(desired, period, period, unknown_);
  }

  /// The last reference again, where no new one has come.
  const Reference& again(double period) noexcept;

  /// Begins a stop from the last reference, unless one has begun already.
  ///
  /// @param joint  whose fault it is, or -1.
  void stop(StopReason reason, Eigen::Index joint = -1) noexcept;

  /// Whether the last reference asks for a motion.
  bool isMoving() const noexcept { return moving_; }

  /// Whether the guard moves to a reference that was too far.
  bool ramping() const noexcept { return ramping_; }

  /// Whether a stop has begun, why, and the first joint that made it (-1: none in particular).
  bool stopped() const noexcept { return reason_ != StopReason::kNone; }
  StopReason reason() const noexcept { return reason_; }
  Eigen::Index joint() const noexcept { return joint_; }

 private:
  // Moves followed_ to a reference by one period; whether it was there.
  bool approach(const Reference& desired, double period) noexcept;

  ReferenceLimits limits_;
  std::vector<chain_dynamics::JointType> types_;
  SafeStop safe_stop_;
  Steps steps_;
  OwnedVector slope_;  // of ramps: rad/s^2
  Reference followed_;
  JointState unknown_;
  bool following_ = false;  // else the reference is that of safe_stop_
  bool moving_ = false, ramping_ = false;
  StopReason reason_ = StopReason::kNone;
  Eigen::Index joint_ = -1;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
