// SPDX-License-Identifier: Apache-2.0

/// @file
/// Transposing, two columns at a time.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "structure.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

// Lanes of a, then of b, by their numbers; constants of the compiler.
#if __has_builtin(__builtin_shufflevector)
#define FAST_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else  // GCC before 12
#define FAST_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, PackBits{__VA_ARGS__})
#endif

// Numbers two by two: from[0], from[1], from[step], from[step + 1], ...
FAST_INLINE Pack loadPairs(const double* from, [[maybe_unused]] std::ptrdiff_t step) {
#if !defined(__AVX__)
  return load<Pack>(from);
#elif !__has_builtin(__builtin_shufflevector)
  Pack pairs;
  for (int k = 0; k < kWidth; ++k) pairs[k] = from[k / 2 * step + k % 2];
  return pairs;
#else
  using Pair __attribute__((vector_size(2 * sizeof(double)))) = double;
  const auto two = FAST_SHUFFLE(load<Pair>(from), load<Pair>(from + step), 0, 1, 2, 3);
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  from += 2 * step;
  return FAST_SHUFFLE(two, FAST_SHUFFLE(load<Pair>(from), load<Pair>(from + step), 0, 1, 2, 3), 0,
                      1, 2, 3, 4, 5, 6, 7);
#else
  return two;
#endif
#endif
}

/// The columns rows[0 ..] and rows[1 ..] of as many rows as a pack has lanes, `step` from one row
/// to the next.
FAST_INLINE void loadColumns(const double* rows, std::ptrdiff_t step, Pack& first, Pack& second) {
  const Pack even = loadPairs(rows, 2 * step);
  const Pack odd = loadPairs(rows + step, 2 * step);
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  first = FAST_SHUFFLE(even, odd, 0, 8, 2, 10, 4, 12, 6, 14);
  second = FAST_SHUFFLE(even, odd, 1, 9, 3, 11, 5, 13, 7, 15);
#elif defined(__AVX__)
  first = FAST_SHUFFLE(even, odd, 0, 4, 2, 6);
  second = FAST_SHUFFLE(even, odd, 1, 5, 3, 7);
#else
  first = FAST_SHUFFLE(even, odd, 0, 2);
  second = FAST_SHUFFLE(even, odd, 1, 3);
#endif
}

#if defined(__AVX512F__) && defined(__AVX512DQ__)
template <int Half>
FAST_INLINE Short halfOf(const Pack& pack) {
#if __has_builtin(__builtin_shufflevector)
  return __builtin_shufflevector(pack, pack, 4 * Half, 4 * Half + 1, 4 * Half + 2, 4 * Half + 3);
#else
  return load<Short>(numbersOf(&pack) + 4 * Half);
#endif
}
#endif

/// Of kShortWidth packs the numbers of each lane side by side: those of lane k at to + k step.
FAST_INLINE void storeTransposed(const Pack* rows, double* to, std::ptrdiff_t step) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  countUp<0, 2>([&](auto is_odd) FAST_LAMBDA {
    constexpr int kOdd = is_odd;
    const Pack low = FAST_SHUFFLE(rows[0], rows[1], kOdd, 8 + kOdd, 2 + kOdd, 10 + kOdd, 4 + kOdd,
                                  12 + kOdd, 6 + kOdd, 14 + kOdd);
    const Pack high = FAST_SHUFFLE(rows[2], rows[3], kOdd, 8 + kOdd, 2 + kOdd, 10 + kOdd, 4 + kOdd,
                                   12 + kOdd, 6 + kOdd, 14 + kOdd);
    const Pack first = FAST_SHUFFLE(low, high, 0, 1, 8, 9, 4, 5, 12, 13);
    const Pack third = FAST_SHUFFLE(low, high, 2, 3, 10, 11, 6, 7, 14, 15);
    store(halfOf<0>(first), to + kOdd * step);
    store(halfOf<0>(third), to + (2 + kOdd) * step);
    store(halfOf<1>(first), to + (4 + kOdd) * step);
    store(halfOf<1>(third), to + (6 + kOdd) * step);
  });
#elif defined(__AVX__)
  countUp<0, 2>([&](auto is_odd) FAST_LAMBDA {
    constexpr int kOdd = is_odd;
    const Pack low = FAST_SHUFFLE(rows[0], rows[1], kOdd, 4 + kOdd, 2 + kOdd, 6 + kOdd);
    const Pack high = FAST_SHUFFLE(rows[2], rows[3], kOdd, 4 + kOdd, 2 + kOdd, 6 + kOdd);
    store(FAST_SHUFFLE(low, high, 0, 1, 4, 5), to + kOdd * step);
    store(FAST_SHUFFLE(low, high, 2, 3, 6, 7), to + (2 + kOdd) * step);
  });
#else
  store(FAST_SHUFFLE(rows[0], rows[1], 0, 2), to);
  store(FAST_SHUFFLE(rows[0], rows[1], 1, 3), to + step);
#endif
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
