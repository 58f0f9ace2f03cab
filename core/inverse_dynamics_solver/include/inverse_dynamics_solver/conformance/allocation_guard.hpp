// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts heap allocations of a piece of code, in every library that it calls.
///
///     AllocationGuard guard;
///     solver->getTorques(q, qd, qdd, tau);
///     EXPECT_EQ(guard.count(), 0);
///
/// How: this header defines malloc and its relatives, which count and pass the call on to the C
/// library. A definition in the program takes precedence over the C library's in all shared libraries,
/// operator new and Eigen included. Each thread counts for itself.
///
/// Include it in test programs only. Where it can't work (another C library than glibc; a
/// sanitizer, which has a malloc of its own) kAllocationGuardWorks is false.
#pragma once

#include <Eigen/Core>  // Clang's mm_malloc.h must declare posix_memalign before it is defined here
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__has_feature)
#define INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(x) __has_feature(x)
#else
#define INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(x) 0
#endif

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(address_sanitizer) &&                               \
    !INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(thread_sanitizer) &&                                \
    !INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(memory_sanitizer) &&                                \
    !INVERSE_DYNAMICS_SOLVER_HAS_FEATURE(realtime_sanitizer)
#define INVERSE_DYNAMICS_SOLVER_COUNT_ALLOCATIONS
#endif

namespace inverse_dynamics_solver::conformance {

/// Allocations of this thread so far.
inline thread_local long allocation_count = 0;

/// Allocations of the calling thread since it was made.
class AllocationGuard {
 public:
  AllocationGuard() : start_(allocation_count) {}
  long count() const { return allocation_count - start_; }

 private:
  long start_;
};

#ifdef INVERSE_DYNAMICS_SOLVER_COUNT_ALLOCATIONS
constexpr bool kAllocationGuardWorks = true;
#else
constexpr bool kAllocationGuardWorks = false;
#endif

}  // namespace inverse_dynamics_solver::conformance

#ifdef INVERSE_DYNAMICS_SOLVER_COUNT_ALLOCATIONS

// The C library's own functions, under their second names. All definitions are weak: the header may
// be included in several files of a program.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

__attribute__((weak)) void* malloc(std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  return __libc_malloc(size);
}

__attribute__((weak)) void* calloc(std::size_t count, std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  return __libc_calloc(count, size);
}

__attribute__((weak)) void* realloc(void* memory, std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  return __libc_realloc(memory, size);
}

__attribute__((weak)) void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  return __libc_memalign(alignment, size);
}

__attribute__((weak)) void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  return __libc_memalign(alignment, size);
}

__attribute__((weak)) int posix_memalign(void** memory, std::size_t alignment,
                                         std::size_t size) noexcept {
  ++inverse_dynamics_solver::conformance::allocation_count;
  void* const result = __libc_memalign(alignment, size);
  if (result == nullptr) return ENOMEM;
  *memory = result;
  return 0;
}
}

#endif  // INVERSE_DYNAMICS_SOLVER_COUNT_ALLOCATIONS

#undef INVERSE_DYNAMICS_SOLVER_HAS_FEATURE
