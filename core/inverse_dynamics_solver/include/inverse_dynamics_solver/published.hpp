// SPDX-License-Identifier: Apache-2.0
/// @file
/// A value that one thread replaces while others read it, without a lock on the side of the
/// readers: how a solver's robot changes under a running control loop.
///
///     Published<Robot> robot;
///     robot.reset(std::make_unique<const Robot>(model));         // nobody reads yet
///     const auto now = robot.read();                             // a control loop: this robot ...
///     now->torques(q, qd, qdd, tau);                             // ... until the end of the scope
///     robot.publish(std::make_unique<const Robot>(with_tool));   // any thread: the next read() has it
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace inverse_dynamics_solver {
inline namespace v2 {

/// A constant value, or the one that replaced it last.
///
/// Real time: read() doesn't allocate, lock, throw or make a system call; while the value of reset()
/// is the current one, it is one load and a branch. Writers take a lock and allocate. They never wait
/// for a reader, nor readers for them: a value is destroyed by a later publish(), when nobody reads
/// it any more.
///
/// Threads: read() and the methods that publish are safe; reset() and the destructor need the object
/// for themselves.
template <class T>
class Published {
  using Count = std::atomic<std::uint32_t>;

 public:
  /// A value that stays as it is until the end of the reader's life.
  class Reader {
   public:
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() {
      if (readers_ != nullptr) readers_->fetch_sub(1, std::memory_order_release);
    }
    const T& operator*() const noexcept { return *value_; }
    const T* operator->() const noexcept { return value_; }

   private:
    friend class Published;
    Reader(const T* value, Count* readers) noexcept : value_(value), readers_(readers) {}

    const T* value_;
    Count* readers_;  // null: the initial value, which isn't counted
  };

  Published() = default;
  Published(const Published&) = delete;
  Published& operator=(const Published&) = delete;

  /// Begins with this value; those published before are gone.
  void reset(std::unique_ptr<const T> initial) noexcept {
    current_.store(nullptr, std::memory_order_relaxed);
    slots_.clear();
    initial_ = std::move(initial);
  }

  /// The value of reset(), whatever has been published since.
  const T& initial() const noexcept { return *initial_; }

  /// The value of reset() while it is the current one, else null. It needs no reader: it stays.
  const T* initialIfCurrent() const noexcept {
    return current_.load(std::memory_order_acquire) == nullptr ? initial_.get() : nullptr;
  }

  /// The current value; after reset().
  Reader read() const noexcept {
    Slot* const slot = current_.load(std::memory_order_acquire);
    return slot == nullptr ? Reader(initial_.get(), nullptr) : readSlot(slot);
  }

  /// From now on read() gives this value.
  void publish(std::unique_ptr<const T> value) {
    const std::lock_guard<std::mutex> lock(writers_);
    Slot& slot = unusedSlot();
    slot.value = std::move(value);
    current_.store(&slot, std::memory_order_seq_cst);
  }

  /// From now on read() gives the value of reset() again.
  void publishInitial() {
    const std::lock_guard<std::mutex> lock(writers_);
    current_.store(nullptr, std::memory_order_seq_cst);
  }

 private:
  /// A value and how many readers it has: the sum of counts on cache lines of their own, so that
  /// threads seldom write to the same line.
  struct Slot {
    struct alignas(64) Stripe {
      Count readers{0};
    };
    std::unique_ptr<const T> value;
    std::array<Stripe, 16> stripes;

    bool isRead() const {
      for (const Stripe& stripe : stripes) {
        if (stripe.readers.load(std::memory_order_seq_cst) != 0) return true;
      }
      return false;
    }
  };

  // Why no value changes under a reader (Dekker's algorithm): the reader counts itself, then looks
  // whether the slot is still the current one; the writer makes another slot current, then looks for
  // readers of the old one. All four steps have one order (seq_cst). If the reader found its slot to
  // be current, then its count comes before the writer's search, which finds it. If the writer found
  // none, then the reader comes later, finds another slot to be current and leaves this one alone.
  // The reader's decrement (release) comes before the writer's search (acquire), so what was read is
  // read before it is overwritten.
  Reader readSlot(Slot* slot) const noexcept {
    while (slot != nullptr) {
      Count& readers = slot->stripes[ownStripe()].readers;
      readers.fetch_add(1, std::memory_order_seq_cst);
      Slot* const now = current_.load(std::memory_order_seq_cst);
      if (now == slot) return Reader(slot->value.get(), &readers);
      readers.fetch_sub(1, std::memory_order_release);
      slot = now;  // published in between
    }
    return Reader(initial_.get(), nullptr);
  }

  Slot& unusedSlot() {
    const Slot* const current = current_.load(std::memory_order_relaxed);  // only writers change it
    for (const std::unique_ptr<Slot>& slot : slots_) {
      if (slot.get() != current && !slot->isRead()) return *slot;
    }
    slots_.push_back(std::make_unique<Slot>());
    return *slots_.back();
  }

  /// Differs between most threads: each has a stack of its own. (No thread_local number: its first
  /// use could allocate.)
  static std::size_t ownStripe() noexcept {
    const char here = 0;
    const std::uint64_t page = reinterpret_cast<std::uintptr_t>(&here) >> 14U;
    return static_cast<std::size_t>((page * 0x9E3779B97F4A7C15U) >> 60U);
  }

  std::atomic<Slot*> current_{nullptr};  // null: the initial value
  std::unique_ptr<const T> initial_;
  std::mutex writers_;
  std::vector<std::unique_ptr<Slot>> slots_;  // never freed while somebody may look at a count
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
