// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/scratch.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace chain_dynamics {
namespace {

template <typename T>
bool livesIn(const Scratch<T>& scratch) {
  const auto begin = reinterpret_cast<std::uintptr_t>(&scratch);
  const auto first = reinterpret_cast<std::uintptr_t>(&scratch[0]);
  return begin <= first && first < begin + sizeof(scratch);
}

TEST(Scratch, IsOnTheStackUpToSixtyFourElementsAndOnTheHeapBeyond) {
  EXPECT_TRUE(livesIn(Scratch<double>(1)));
  EXPECT_TRUE(livesIn(Scratch<double>(64)));
  EXPECT_FALSE(livesIn(Scratch<double>(65)));
}

TEST(Scratch, KeepsWhatIsWrittenToIt) {
  for (const Eigen::Index size : {1, 64, 65, 1000}) {
    Scratch<Eigen::Index> scratch(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      scratch[i] = i * i;
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      EXPECT_EQ(scratch[i], i * i);
    }
  }
}

// Counts how many of it exist.
struct Counted {
  static int alive;
  Counted() { ++alive; }
  ~Counted() { --alive; }
};
int Counted::alive = 0;

TEST(Scratch, ConstructsAndDestroysEachElementOnce) {
  for (const Eigen::Index size : {3, 100}) {
    {
      const Scratch<Counted> scratch(size);
      EXPECT_EQ(Counted::alive, size);
    }
    EXPECT_EQ(Counted::alive, 0);
  }
}

struct alignas(64) Wide {
  double lanes[8];
};

TEST(Scratch, IsAlignedForItsElements) {
  for (const Eigen::Index size : {2, 100}) {
    const Scratch<Wide> scratch(size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(&scratch[1]) % 64, 0U);
  }
}

}  // namespace
}  // namespace chain_dynamics
