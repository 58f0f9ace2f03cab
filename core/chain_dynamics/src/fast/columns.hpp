// SPDX-License-Identifier: Apache-2.0

/// @file
/// Transposing, two columns at a time.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>
#include <utility>

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

// Groups of Size lanes of a and b by turns: those with even numbers of both, or those with odd ones.
template <std::size_t Size, bool Odd, std::size_t... Lane>
FAST_INLINE Pack groupsOf(const Pack& a, const Pack& b, std::index_sequence<Lane...>) {
  return FAST_SHUFFLE(
      a, b, (Lane / Size % 2 == 0 ? Lane + (Odd ? Size : 0) : kWidth + Lane - (Odd ? 0 : Size))...);
}
template <std::size_t Size, bool Odd>
FAST_INLINE Pack groupsOf(const Pack& a, const Pack& b) {
  return groupsOf<Size, Odd>(a, b, std::make_index_sequence<kWidth>());
}

/// The columns rows[0 ..] and rows[1 ..] of as many rows as a pack has lanes, `step` from one row
/// to the next.
FAST_INLINE void loadColumns(const double* rows, std::ptrdiff_t step, Pack& first, Pack& second) {
  const Pack even = loadPairs(rows, 2 * step);
  const Pack odd = loadPairs(rows + step, 2 * step);
  first = groupsOf<1, false>(even, odd);
  second = groupsOf<1, true>(even, odd);
}

// kShortWidth lanes of a pack after another, to each `step` after the one before.
FAST_INLINE void storeShorts(const Pack& pack, double* to, [[maybe_unused]] std::ptrdiff_t step) {
#if defined(__AVX512F__) && defined(__AVX512DQ__) && __has_builtin(__builtin_shufflevector)
  store(FAST_SHUFFLE(pack, pack, 0, 1, 2, 3), to);
  store(FAST_SHUFFLE(pack, pack, 4, 5, 6, 7), to + step);
#else
  for (int lane = 0; lane < kWidth; lane += kShortWidth, to += step) {
    store(load<Short>(numbersOf(&pack) + lane), to);
  }
#endif
}

/// Of kShortWidth packs the numbers of each lane side by side: those of lane k at to + k step.
FAST_INLINE void storeTransposed(const Pack* rows, double* to, std::ptrdiff_t step) {
  countUp<0, 2>([&](auto is_odd) FAST_LAMBDA {
    constexpr int kOdd = is_odd;
    const Pack low = groupsOf<1, kOdd != 0>(rows[0], rows[1]);
    if constexpr (kWidth == 2) {
      store(low, to + kOdd * step);
    } else {
      const Pack high = groupsOf<1, kOdd != 0>(rows[2], rows[3]);
      storeShorts(groupsOf<2, false>(low, high), to + kOdd * step, 4 * step);
      storeShorts(groupsOf<2, true>(low, high), to + (2 + kOdd) * step, 4 * step);
    }
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
