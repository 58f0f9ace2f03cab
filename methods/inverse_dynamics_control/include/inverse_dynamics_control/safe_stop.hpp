// SPDX-License-Identifier: Apache-2.0
/// @file
/// References that bring a moving arm to a standstill, for a law that follows references.
///
///     SafeStop stop(deceleration, solver->jointNames());
///     stop.begin(reference.q, reference.qd);       // once, when the stop is wanted
///     stop.advance(period, reference);             // in each cycle, then law.update(...)
///
/// From the velocity v the reference goes on along the same straight line of joint space,
///
///     qdd = -v / T,   T = max_j |v_j| / deceleration_j
///
/// so that all joints stop together after T, each within its deceleration, and stay there.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_control/signals.hpp"
#include "inverse_dynamics_control/status.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Ramps references to a standstill. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call.
class SafeStop {
 public:
  /// @param deceleration  greatest, n, finite, > 0; rad/s^2 (prismatic m/s^2).
  /// @param joint_names   n of them, for the text of errors.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value.
  SafeStop(const Eigen::Ref<const Eigen::VectorXd>& deceleration,
           const std::vector<std::string>& joint_names);

  /// Number n of joints.
  Eigen::Index jointCount() const noexcept { return q_.size(); }

  /// Starts the stop at a motion: that of the last reference, or the measured one.
  ///
  /// @param q,qd  n each; rad, rad/s (prismatic m, m/s).
  /// @return kOk; kReferenceNotFinite or kWrongSize: nothing is changed.
  Status begin(const Eigen::Ref<const Eigen::VectorXd>& q,
               const Eigen::Ref<const Eigen::VectorXd>& qd) noexcept;

  /// The reference one period later; before begin() nothing is written.
  ///
  /// @param period          s; a non-positive one (a clock that jumps back) changes nothing.
  /// @param[out] reference  n.
  /// @return kOk; kReferenceNotFinite before begin(); kWrongSize.
  Status advance(double period, Reference& reference) noexcept;

  /// Whether the reference stands still; false before begin().
  bool finished() const noexcept { return begun_ && time_ >= duration_; }

  /// How long the stop takes [s].
  double duration() const noexcept { return duration_; }

 private:
  OwnedVector deceleration_, q_, qd_;
  double duration_ = 0.0, time_ = 0.0;
  bool begun_ = false;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
