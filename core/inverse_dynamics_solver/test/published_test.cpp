// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/published.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"

namespace inverse_dynamics_solver::published_test {

using conformance::AllocationGuard;
using conformance::kAllocationGuardWorks;

/// As many numbers as a robot has, all the same while it lives.
class Value {
 public:
  explicit Value(int number, std::atomic<int>* living = nullptr)
      : numbers_(500, number), living_(living) {
    if (living_ != nullptr) ++*living_;
  }
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;
  ~Value() {
    for (int& number : numbers_) number = -1;
    if (living_ != nullptr) --*living_;
  }

  int number() const { return numbers_.front(); }
  bool isWhole() const {
    for (const int number : numbers_) {
      if (number < 0 || number != numbers_.front()) return false;
    }
    return true;
  }

 private:
  std::vector<int> numbers_;
  std::atomic<int>* living_;
};

std::unique_ptr<const Value> value(int number, std::atomic<int>* living = nullptr) {
  return std::make_unique<const Value>(number, living);
}

TEST(Published, ReadGivesTheLatestValueAndTheInitialOneAgain) {
  Published<Value> published;
  published.reset(value(1));
  EXPECT_EQ(published.read()->number(), 1);
  published.publish(value(2));
  EXPECT_EQ(published.read()->number(), 2);
  EXPECT_EQ((*published.read()).number(), 2);
  EXPECT_EQ(published.initial().number(), 1);
  published.publish(value(3));
  EXPECT_EQ(published.read()->number(), 3);
  published.publishInitial();
  EXPECT_EQ(published.read()->number(), 1);
  published.publish(value(4));
  published.reset(value(5));
  EXPECT_EQ(published.read()->number(), 5);
}

TEST(Published, WhatIsReadLivesUntilTheReaderEnds) {
  std::atomic<int> living{0};
  Published<Value> published;
  published.reset(value(0));
  published.publish(value(1, &living));
  {
    const auto reader = published.read();
    for (int number = 2; number < 10; ++number) published.publish(value(number, &living));
    EXPECT_EQ(reader->number(), 1);
    EXPECT_TRUE(reader->isWhole());
    EXPECT_EQ(published.read()->number(), 9);
    EXPECT_LE(living, 3) << "values that nobody reads are kept";
  }
  // Its place is used again.
  for (int number = 10; number < 20; ++number) published.publish(value(number, &living));
  EXPECT_EQ(published.read()->number(), 19);
  EXPECT_LE(living, 3);
}

TEST(Published, ReadingDoesNotAllocate) {
  if (!kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted in this build";
  Published<Value> published;
  published.reset(value(1));
  int sum = 0;
  AllocationGuard initial;
  sum += published.read()->number();
  EXPECT_EQ(initial.count(), 0);
  published.publish(value(2));
  AllocationGuard replaced;
  sum += published.read()->number();
  EXPECT_EQ(replaced.count(), 0);
  EXPECT_EQ(sum, 3);
}

/// Under ThreadSanitizer this also proves that no value is read while it is made or destroyed.
TEST(Published, ManyThreadsSeeWholeValuesInTheOrderOfPublication) {
  constexpr int kReaders = 8, kWriters = 2, kValues = 4000;
  Published<Value> published;
  published.reset(value(0));
  std::atomic<int> next{0}, broken{0}, disordered{0}, working{kWriters};

  const auto read = [&](bool twice) {
    int last = 0;
    while (working > 0) {
      const auto reader = published.read();
      const auto nested = published.read();
      if (!reader->isWhole() || (twice && !nested->isWhole())) ++broken;
      const int number = nested->number();
      if (number != 0 && number < last) ++disordered;
      if (number != 0) last = number;
    }
  };
  std::mutex order;
  const auto write = [&] {
    for (int k = 0; k < kValues; ++k) {
      {
        const std::lock_guard<std::mutex> lock(order);
        published.publish(value(++next));
      }
      if (k % 64 == 0) published.publishInitial();
      if (k % 16 == 0) std::this_thread::yield();
    }
    --working;
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < kReaders; ++i) threads.emplace_back(read, i % 2 == 0);
  for (int i = 0; i < kWriters; ++i) threads.emplace_back(write);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(broken, 0) << "a value changed while it was read";
  EXPECT_EQ(disordered, 0) << "an older value was read after a newer one";
}

}  // namespace inverse_dynamics_solver::published_test
