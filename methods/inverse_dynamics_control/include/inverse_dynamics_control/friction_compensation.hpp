// SPDX-License-Identifier: Apache-2.0
/// @file
/// Friction torque that a law may add without making the arm creep or chatter.
///
///     FrictionOptions options;
///     options.source = FrictionSource::kMeasuredVelocity;   // hand guiding
///     options.dead_band = 0.02;                             // rad/s: what noise stays below
///     FrictionCompensation friction(options, "gravity compensation");
///     friction.weigh(qd, f);                                // f = getFrictionVector(q, qd)
///
/// Identified friction jumps at zero speed (slopes of 500 N m s/rad are common) and isn't even zero
/// there (the UR10's: up to 4.5 N m at rest). Added as it is, it would push a resting arm and
/// change its sign with every noisy sample. So it is blended in with the speed v of each joint:
///
///     f_compensated = scale w(|v|) f(v),   w(s) = 3 x^2 - 2 x^3,   x = (s - dead_band) / blend
///
/// with x cut to [0, 1]: nothing at rest, all of it from dead_band + blend on, and smooth between.
///
/// Friction with memory [inverse_dynamics_solver/friction_memory.hpp] is that after the motion so far. What
/// a joint remembers when it stops it keeps, so with the velocity of a reference this part acts at rest, too:
/// it is constant while the reference stands. With the measured velocity it doesn't: an arm that is let go
/// must not creep.
#pragma once

#include <Eigen/Core>
#include <string>

namespace inverse_dynamics_control {
inline namespace v2 {

/// The velocity v from which friction is computed.
enum class FrictionSource {
  kNone,               ///< no friction compensation
  kReferenceVelocity,  ///< the desired one: free of noise, no feedback. The choice for tracking.
  kMeasuredVelocity,   ///< the measured one: for hand guiding, which has no reference
};

/// How friction is compensated.
struct FrictionOptions {
  FrictionSource source = FrictionSource::kReferenceVelocity;

  /// Speed below which there is none [rad/s; prismatic m/s], >= 0. With the measured velocity it
  /// must be above zero: noise must stay below it.
  double dead_band = 0.0;

  /// Over how much speed it is blended in [rad/s; prismatic m/s], > 0.
  double blend = 0.05;

  /// Part of the model's friction that is compensated, 0 to 1. Below one with the measured
  /// velocity: more friction than there is pushes the arm on.
  double scale = 1.0;
};

/// Weights friction with speed. Constant after construction. Threads: safe.
class FrictionCompensation {
 public:
  /// @param law  whose options these are, for the text of errors.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: a number out of its range.
  FrictionCompensation(const FrictionOptions& options, const std::string& law);

  FrictionSource source() const noexcept { return options_.source; }

  /// Weight `scale w(|v|)` of one joint's friction at velocity v.
  double weight(double v) const noexcept;

  /// Multiplies each joint's friction by its weight.
  ///
  /// @param v         n; velocities at which f was computed.
  /// @param[in,out] f n; N m (prismatic N).
  /// Real time: no allocation, lock, exception or system call.
  void weigh(const Eigen::Ref<const Eigen::VectorXd>& v,
             Eigen::Ref<Eigen::VectorXd> f) const noexcept;

  /// Multiplies what each joint remembers at rest by `scale (1 - w(|v|))`, with the velocity of a reference,
  /// and by zero with the measured one; as weigh().
  void weighRest(const Eigen::Ref<const Eigen::VectorXd>& v,
                 Eigen::Ref<Eigen::VectorXd> f) const noexcept;

 private:
  FrictionOptions options_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
