// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs a piece of code where the kernel ends the process at its first system call.
///
///     EXPECT_EQ(runWithoutSystemCalls([&] { solver->getTorques(q, qd, qdd, tau); }),
///               SystemCalls::kNone);
///
/// How: a child process allows itself nothing but to exit (a seccomp filter). Linux only;
/// elsewhere, with a sanitizer, and where the kernel refuses the filter, the answer is kNotKnown.
#pragma once

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"

#if defined(__linux__) && defined(INVERSE_DYNAMICS_SOLVER_COUNT_ALLOCATIONS)
#define INVERSE_DYNAMICS_SOLVER_FORBID_SYSTEM_CALLS
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#endif

namespace inverse_dynamics_solver::conformance {

enum class SystemCalls {
  kNone,
  kMade,
  kFailed,   ///< the code threw or crashed
  kNotKnown  ///< can't be forbidden here
};

#ifdef INVERSE_DYNAMICS_SOLVER_FORBID_SYSTEM_CALLS

/// From here on, any system call but `exit` ends the process with SIGSYS. False if refused.
inline bool forbidSystemCalls() {
  std::array<sock_filter, 4> program = {{
      {BPF_LD | BPF_W | BPF_ABS, 0, 0, offsetof(seccomp_data, nr)},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, SYS_exit},
      {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW},
      {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_KILL},
  }};
  const sock_fprog filter = {static_cast<unsigned short>(program.size()), program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

template <typename Code>
SystemCalls runWithoutSystemCalls(const Code& code) {
  constexpr int kRefused = 2, kThrown = 3;
  const pid_t child = fork();
  if (child < 0) return SystemCalls::kNotKnown;
  if (child == 0) {
    if (!forbidSystemCalls()) syscall(SYS_exit, kRefused);
    try {
      code();
      syscall(SYS_exit, 0);
    } catch (...) {
      syscall(SYS_exit, kThrown);
    }
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child) return SystemCalls::kNotKnown;
  if (WIFSIGNALED(status)) {
    return WTERMSIG(status) == SIGSYS ? SystemCalls::kMade : SystemCalls::kFailed;
  }
  if (WEXITSTATUS(status) == kRefused) return SystemCalls::kNotKnown;
  return WEXITSTATUS(status) == 0 ? SystemCalls::kNone : SystemCalls::kFailed;
}

#else

template <typename Code>
SystemCalls runWithoutSystemCalls(const Code& /*code*/) {
  return SystemCalls::kNotKnown;
}

#endif

}  // namespace inverse_dynamics_solver::conformance
