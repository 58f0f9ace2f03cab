// SPDX-License-Identifier: Apache-2.0
#include "latest_value.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace inverse_dynamics_controllers {
namespace {

TEST(LatestValue, GivesTheNewestOnceOnly) {
  LatestValue<int> value(0);
  EXPECT_EQ(value.take(), nullptr);
  for (const int written : {1, 2}) {
    value.back() = written;
    value.publish();
  }
  const int* const taken = value.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 2);
  EXPECT_EQ(value.take(), nullptr);
}

TEST(LatestValue, WhatIsReadIsWholeAndNeverOlder) {
  constexpr int kLast = 200000;
  LatestValue<std::vector<int>> value(std::vector<int>(8, 0));
  std::thread writer([&value] {
    for (int k = 1; k <= kLast; ++k) {
      for (int& number : value.back()) number = k;
      value.publish();
    }
  });
  int last = 0;
  while (last < kLast) {
    const std::vector<int>* const taken = value.take();
    if (taken == nullptr) continue;
    const int first = taken->front();
    ASSERT_GT(first, last);
    for (const int number : *taken) ASSERT_EQ(number, first);
    last = first;
  }
  writer.join();
}

}  // namespace
}  // namespace inverse_dynamics_controllers
