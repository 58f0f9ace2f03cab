// SPDX-License-Identifier: Apache-2.0
/// @file
/// How an update ended, as a number that a control loop can act on.
///
///     const Status status = law.update(state, reference, period, tau);
///     if (isRefusal(status)) RCLCPP_ERROR_THROTTLE(logger, clock, 1000, "%s", text(status));
#pragma once

namespace inverse_dynamics_control {
inline namespace v2 {

/// Result of an update. From kReferenceNotFinite on the command was refused, and the output is the
/// safe torque [control_law.hpp].
enum class Status {
  kOk,                  ///< the law's torque, as it is
  kSaturated,           ///< a joint's torque was cut to its effort limit: ControlLaw::saturated()
  kRateLimited,         ///< a joint's torque changes slower than desired: ControlLaw::rateLimited()
  kNoPeriod,            ///< a period not above zero and up to 1 s: joints with a rate limit hold
  kReferenceNotFinite,  ///< a reference, or the effort of another controller, is NaN or infinite
  kStateNotFinite,      ///< a measured position or velocity is NaN or infinite
  kTorqueNotFinite,     ///< the law's torque is NaN or infinite though its inputs aren't
  kSolverFailed,        ///< the solver threw
  kWrongSize,           ///< an argument hasn't one number per joint
};

/// Whether the law's torque was refused, so that the output is the safe torque.
constexpr bool isRefusal(Status status) noexcept { return status >= Status::kReferenceNotFinite; }

/// Text of a message, without a full stop. Real time: no allocation, lock, exception or
/// system call. Threads: safe.
const char* text(Status status) noexcept;

}  // namespace v2
}  // namespace inverse_dynamics_control
