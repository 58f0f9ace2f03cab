// SPDX-License-Identifier: Apache-2.0
/// @file
/// A value handed from one thread to another, the newest only, without a lock.
///
/// RealtimeThreadSafeBox of realtime_tools tries a lock instead: while the other thread holds it, a
/// cycle keeps an old value, or loses one to publish.
///
///     LatestValue<std::vector<double>> mailbox(std::vector<double>(6));
///     mailbox.back().assign(...); mailbox.publish();                      // one thread
///     if (const auto* value = mailbox.take()) use(*value);                // the other one
#pragma once

#include <array>
#include <atomic>

namespace inverse_dynamics_controllers {

/// Three values: one is written, one is read, and the one between changes hands atomically.
///
/// One writing and one reading thread. Real time: take() and publish(): no allocation, lock or
/// system call.
template <class T>
class LatestValue {
 public:
  explicit LatestValue(const T& initial) : values_{initial, initial, initial} {}

  /// Where the writing thread prepares the next value.
  T& back() noexcept { return values_[back_]; }

  /// Hands over what back() holds.
  void publish() noexcept {
    back_ = between_.exchange(back_ | kNew, std::memory_order_acq_rel) & ~kNew;
  }

  /// The newest value if there is a new one since the last call, else null; good until the next
  /// call.
  const T* take() noexcept {
    if ((between_.load(std::memory_order_relaxed) & kNew) == 0) return nullptr;
    front_ = between_.exchange(front_, std::memory_order_acq_rel) & ~kNew;
    return &values_[front_];
  }

 private:
  static constexpr unsigned kNew = 4;  // beside the index
  std::array<T, 3> values_;
  unsigned back_ = 0, front_ = 2;
  std::atomic<unsigned> between_{1};
};

}  // namespace inverse_dynamics_controllers
