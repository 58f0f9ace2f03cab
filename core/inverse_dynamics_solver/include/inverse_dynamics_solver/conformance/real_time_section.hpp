// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs a piece of code as a control loop would.
///
///     inRealTime([&] { law.update(state, reference, period, tau); });
///
/// An exception ends the program. Built with RealtimeSanitizer (Clang 20 and newer,
/// -fsanitize=realtime), so does an allocation, a lock or a blocking system call, in every library
/// that the code calls; kRealtimeSanitizerWatches says whether it is.
#pragma once

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#define INVERSE_DYNAMICS_SOLVER_REALTIME_SANITIZER
#endif
#endif

namespace inverse_dynamics_solver::conformance {

#ifdef INVERSE_DYNAMICS_SOLVER_REALTIME_SANITIZER

constexpr bool kRealtimeSanitizerWatches = true;

template <typename Code>
void inRealTime(const Code& code) noexcept [[clang::nonblocking]] {
  code();
}

#else

constexpr bool kRealtimeSanitizerWatches = false;

template <typename Code>
void inRealTime(const Code& code) noexcept {
  code();
}

#endif

}  // namespace inverse_dynamics_solver::conformance
