// SPDX-License-Identifier: Apache-2.0

/// @file
/// Scratch memory of an algorithm: an array that lives on the stack, for chains of usual length.
///
///     Scratch<Motion<double>> V(chain.jointCount());   // V[0] .. V[n - 1], not initialised
///     V[0] = Motion<double>::zero();

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstddef>
#include <memory>
#include <new>

namespace chain_dynamics {
inline namespace v2 {

/// Chains of up to this many joints need no memory but the stack.
constexpr Eigen::Index kStackJoints = 64;

/// Array of a size known at run time: on the stack up to StackSize elements, else on the heap.
///
/// This is why the algorithms promise no allocation up to 64 joints. An algorithm on double keeps
/// at most 24 KiB on the stack, one on a dual number with N directions (a derivative: one) N + 1 times
/// as much. A longer chain allocates, and may throw std::bad_alloc.
///
/// @tparam T  elements are default-constructed: structs of Eigen vectors of double stay as they
///     are in memory, which costs nothing.
template <typename T, Eigen::Index StackSize = kStackJoints>
class Scratch {
 public:
  explicit Scratch(Eigen::Index size)
      : size_(static_cast<std::size_t>(size)),
        data_(size <= StackSize ? reinterpret_cast<T*>(stack_)
                                : std::allocator<T>().allocate(size_)) {
    std::uninitialized_default_construct_n(data_, size_);
  }

  ~Scratch() {
    std::destroy_n(data_, size_);
    if (data_ != reinterpret_cast<T*>(stack_)) std::allocator<T>().deallocate(data_, size_);
  }

  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  T& operator[](Eigen::Index i) {
    assert(0 <= i && static_cast<std::size_t>(i) < size_);
    return data_[i];
  }
  const T& operator[](Eigen::Index i) const {
    assert(0 <= i && static_cast<std::size_t>(i) < size_);
    return data_[i];
  }

 private:
  alignas(T) unsigned char stack_[sizeof(T) * StackSize];
  std::size_t size_;
  T* data_;
};

}  // namespace v2
}  // namespace chain_dynamics
