// SPDX-License-Identifier: Apache-2.0

/// @file
/// A few numbers side by side, by the vector types of GCC and Clang: the same source for SSE, AVX,
/// AVX-512, NEON.
///
/// Included by kernels.cpp and many_kernels.cpp only, which are compiled once per instruction set:
/// everything here has internal linkage, so that no function compiled for one set is linked in place
/// of another.

#pragma once

#include <cstddef>
#include <utility>

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

#define FAST_INLINE inline __attribute__((always_inline))
#define FAST_LAMBDA __attribute__((always_inline))
#define FAST_APART __attribute__((noinline))

#if defined(__AVX512F__) && defined(__AVX512DQ__)
constexpr int kWidth = 8;
#elif defined(__AVX__)
constexpr int kWidth = 4;
#else
constexpr int kWidth = 2;
#endif
constexpr int kShortWidth = kWidth < 4 ? kWidth : 4;

using Pack __attribute__((vector_size(kWidth * sizeof(double)))) = double;
using PackBits __attribute__((vector_size(kWidth * sizeof(double)))) = long long;

// For the joints of one robot: few, so that wider packs would be empty.
using Short __attribute__((vector_size(kShortWidth * sizeof(double)))) = double;
using ShortBits __attribute__((vector_size(kShortWidth * sizeof(double)))) = long long;

template <typename V>
struct Traits;
template <>
struct Traits<Short> {
  using Bits = ShortBits;
};
#if defined(__AVX512F__) && defined(__AVX512DQ__)
template <>
struct Traits<Pack> {
  using Bits = PackBits;
};
#endif
template <typename V>
using BitsOf = typename Traits<V>::Bits;
template <typename V>
constexpr int kLanes = static_cast<int>(sizeof(V) / sizeof(double));

template <typename V>
FAST_INLINE V load(const double* from) {
  V v;
  __builtin_memcpy(&v, from, sizeof(V));
  return v;
}

// Numbers that don't stand side by side: from[0], from[step], ...
template <std::size_t... Lane>
FAST_INLINE Pack loadLanes(const double* from, std::ptrdiff_t step, std::index_sequence<Lane...>) {
  return Pack{from[static_cast<std::ptrdiff_t>(Lane) * step]...};
}
FAST_INLINE Pack loadSteps(const double* from, std::ptrdiff_t step) {
  return loadLanes(from, step, std::make_index_sequence<kWidth>());
}

template <typename V>
FAST_INLINE void store(const V& v, double* to) {
  __builtin_memcpy(to, &v, sizeof(V));
}

template <std::size_t... Lane>
FAST_INLINE void storeLanes(const Pack& pack, double* to, std::ptrdiff_t step,
                            std::index_sequence<Lane...>) {
  ((to[static_cast<std::ptrdiff_t>(Lane) * step] = pack[Lane]), ...);
}
FAST_INLINE void storeSteps(const Pack& pack, double* to, std::ptrdiff_t step) {
  storeLanes(pack, to, step, std::make_index_sequence<kWidth>());
}

template <typename V>
FAST_INLINE double laneOf(const V& v, int lane) {
  return v[lane];
}

// The numbers of packs stand side by side in memory.
template <typename V>
FAST_INLINE double* numbersOf(V* packs) {
  return reinterpret_cast<double*>(packs);
}
template <typename V>
FAST_INLINE const double* numbersOf(const V* packs) {
  return reinterpret_cast<const double*>(packs);
}

// All lanes the same number.
template <typename V>
FAST_INLINE V all(double number) {
  return number - V{};
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
