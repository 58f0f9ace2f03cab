// SPDX-License-Identifier: Apache-2.0

/// @file
/// As many packs as a pack has lanes, and their transpose.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include "pack.hpp"

namespace chain_dynamics::fast {
namespace {

// Lanes of a, then of b, by their numbers; constants of the compiler.
#if defined(__clang__)
#define FAST_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define FAST_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, PackBits{__VA_ARGS__})
#endif

// Of two rows that stand `Step` apart: the blocks of `Step` columns above and below the diagonal
// change places.
template <int Step>
FAST_INLINE void exchange(Pack& a, Pack& b) {
  const Pack upper = a;
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (Step == 1) {
    a = FAST_SHUFFLE(upper, b, 0, 8, 2, 10, 4, 12, 6, 14);
    b = FAST_SHUFFLE(upper, b, 1, 9, 3, 11, 5, 13, 7, 15);
  } else if constexpr (Step == 2) {
    a = FAST_SHUFFLE(upper, b, 0, 1, 8, 9, 4, 5, 12, 13);
    b = FAST_SHUFFLE(upper, b, 2, 3, 10, 11, 6, 7, 14, 15);
  } else {
    a = FAST_SHUFFLE(upper, b, 0, 1, 2, 3, 8, 9, 10, 11);
    b = FAST_SHUFFLE(upper, b, 4, 5, 6, 7, 12, 13, 14, 15);
  }
#elif defined(__AVX__)
  if constexpr (Step == 1) {
    a = FAST_SHUFFLE(upper, b, 0, 4, 2, 6);
    b = FAST_SHUFFLE(upper, b, 1, 5, 3, 7);
  } else {
    a = FAST_SHUFFLE(upper, b, 0, 1, 4, 5);
    b = FAST_SHUFFLE(upper, b, 2, 3, 6, 7);
  }
#else
  a = FAST_SHUFFLE(upper, b, 0, 2);
  b = FAST_SHUFFLE(upper, b, 1, 3);
#endif
}

struct Square {
  Pack rows[kWidth];

  FAST_INLINE void transpose() { exchangeRows<1>(); }

 private:
  template <int Step, int Row = 0>
  FAST_INLINE void exchangeRows() {
    if constexpr (Row < kWidth) {
      if constexpr ((Row & Step) == 0) exchange<Step>(rows[Row], rows[Row + Step]);
      exchangeRows<Step, Row + 1>();
    } else if constexpr (2 * Step < kWidth) {
      exchangeRows<2 * Step>();
    }
  }
};

}  // namespace
}  // namespace chain_dynamics::fast
