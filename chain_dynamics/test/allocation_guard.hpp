// SPDX-License-Identifier: Apache-2.0

/// @file
/// Counts heap allocations of the calling thread.
///
///     AllocationGuard guard;
///     torques(chain, q, qd, qdd, tau);
///     EXPECT_EQ(guard.count(), 0);
///
/// The program's own malloc and its relatives stand before those of the C library, which
/// operator new and Eigen call; they are weak, so that several source files of a program may
/// include them. Needs the GNU C library and no sanitizer that does the same.

#pragma once

#include <Eigen/Core>  // Clang's mm_malloc.h must declare posix_memalign before it is defined here
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define CHAIN_DYNAMICS_COUNTS_ALLOCATIONS 0
#else
#define CHAIN_DYNAMICS_COUNTS_ALLOCATIONS 1
#endif

namespace chain_dynamics::test {

inline thread_local long allocation_count = 0;

/// Counts from its construction on.
class AllocationGuard {
 public:
  AllocationGuard() : before_(allocation_count) {}
  long count() const { return allocation_count - before_; }

 private:
  long before_;
};

}  // namespace chain_dynamics::test

#if CHAIN_DYNAMICS_COUNTS_ALLOCATIONS

extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

__attribute__((weak)) void* malloc(std::size_t size) noexcept {
  ++chain_dynamics::test::allocation_count;
  return __libc_malloc(size);
}

__attribute__((weak)) void* calloc(std::size_t count, std::size_t size) noexcept {
  ++chain_dynamics::test::allocation_count;
  return __libc_calloc(count, size);
}

__attribute__((weak)) void* realloc(void* memory, std::size_t size) noexcept {
  ++chain_dynamics::test::allocation_count;
  return __libc_realloc(memory, size);
}

__attribute__((weak)) void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++chain_dynamics::test::allocation_count;
  return __libc_memalign(alignment, size);
}

__attribute__((weak)) int posix_memalign(void** memory, std::size_t alignment,
                                         std::size_t size) noexcept {
  ++chain_dynamics::test::allocation_count;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

}  // extern "C"

#endif
