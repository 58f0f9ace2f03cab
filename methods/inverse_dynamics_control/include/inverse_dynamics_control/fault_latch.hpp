// SPDX-License-Identifier: Apache-2.0
/// @file
/// Latches a fault that lasts, until reset().
///
///     FaultLatch fault(0.05);                                      // s
///     const Status status = fault.latched() ? law.hold(state, period, tau)
///                                           : law.update(state, reference, period, tau);
///     fault.note(status, period);
#pragma once

#include "inverse_dynamics_control/status.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Latches once updates have been refused for longer than is tolerated. Not thread-safe.
///
/// Real time: no allocation, lock, exception or system call.
class FaultLatch {
 public:
  /// @param tolerated  s; a run of refusals that isn't longer changes nothing.
  explicit FaultLatch(double tolerated) noexcept : tolerated_(tolerated) {}

  /// Forgets everything.
  void reset() noexcept { *this = FaultLatch(tolerated_); }

  /// Counts a cycle.
  ///
  /// @param period  s since the last cycle; a non-positive one doesn't count as time.
  void note(Status status, double period) noexcept {
    if (latched_) return;
    if (!isRefusal(status)) {
      refused_ = 0.0;
      return;
    }
    if (period > 0) refused_ += period;
    if (refused_ > tolerated_) {
      latched_ = true;
      why_ = status;
    }
  }

  /// Whether refusals lasted too long since reset(), and the last of them.
  bool latched() const noexcept { return latched_; }
  Status why() const noexcept { return why_; }

 private:
  double tolerated_, refused_ = 0.0;  // s
  bool latched_ = false;
  Status why_ = Status::kOk;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
