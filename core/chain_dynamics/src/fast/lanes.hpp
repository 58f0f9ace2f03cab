// SPDX-License-Identifier: Apache-2.0

/// @file
/// States as lanes: from and to memory of any layout.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>

#include "columns.hpp"
#include "robot.hpp"
#include "structure.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// The states of one pack: lanes beyond the last state repeat it.
struct Lanes {
  std::ptrdiff_t first;
  int count;

  std::ptrdiff_t operator[](int lane) const { return first + (lane < count ? lane : count - 1); }
};

// one(lanes) for packs of states from the first to the last.
template <typename One>
FAST_INLINE void forEachPack(std::ptrdiff_t states, const One& one) {
  for (std::ptrdiff_t k = 0; k < states; k += kWidth) {
    const std::ptrdiff_t left = states - k;
    one(Lanes{k, left < kWidth ? static_cast<int>(left) : kWidth});
  }
}

/// How many joints the robot has: N, if that isn't zero, and then for the compiler to know.
template <int N>
FAST_INLINE int jointsOf(const Robot& robot) {
  return N > 0 ? N : robot.joints;
}

// each(i) for i = 0 .. count - 1; count is N, if that isn't zero.
template <int N, typename Each>
FAST_INLINE void forEachOf(int count, const Each& each) {
  if constexpr (N > 0) {
    countUp<0, N>(each);
  } else {
    for (int i = 0; i < count; ++i) each(i);
  }
}

/// For numbers that stand side by side: whole(first) for blocks of Size of them, the last of which
/// may overlap the one before; one(i) where there are fewer. Their count is N, if that isn't zero.
template <int Size, int N, typename Whole, typename One>
FAST_INLINE void inBlocks(int count, const Whole& whole, const One& one) {
  if (count < Size) return forEachOf<N>(count, one);
  forEachOf<N / Size>(count / Size, [&](auto block) FAST_LAMBDA { whole(Size * block); });
  if (count % Size != 0) whole(count - Size);
}

// The common cases have no branch per number: a full pack of states that stand apart, each with its
// numbers side by side, or of states that stand side by side themselves.
template <int N = 0>
FAST_INLINE void gather(const Robot& robot, const Samples& from, const Lanes& lanes, Pack* to) {
  const std::ptrdiff_t step = from.state_step;
  const double* const first = from.data + lanes.first * step;
  const int n = jointsOf<N>(robot);
  const auto one = [&](int i) FAST_LAMBDA { to[i] = loadSteps(first + i * from.joint_step, step); };
  if (lanes.count < kWidth) {
    for (int i = 0; i < n; ++i) {
      for (int lane = 0; lane < kWidth; ++lane) {
        to[i][lane] = from.data[lanes[lane] * step + i * from.joint_step];
      }
    }
  } else if (step == 1) {
    forEachOf<N>(n, [&](int i) FAST_LAMBDA { to[i] = load<Pack>(first + i * from.joint_step); });
  } else if (from.joint_step == 1) {
    inBlocks<2, N>(
        n, [&](int i) FAST_LAMBDA { loadColumns(first + i, step, to[i], to[i + 1]); }, one);
  } else {
    for (int i = 0; i < n; ++i) one(i);
  }
}

// packs[i], `count` of them (N, if that isn't zero), to the numbers of each state at
// to[i pack_step + state state_step].
template <int N = 0>
FAST_INLINE void scatter(const Pack* packs, int count, const Lanes& lanes, double* to,
                         std::ptrdiff_t pack_step, std::ptrdiff_t state_step) {
  to += lanes.first * state_step;
  const auto one = [&](int i) FAST_LAMBDA { storeSteps(packs[i], to + i * pack_step, state_step); };
  if (lanes.count < kWidth) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < lanes.count; ++k) to[i * pack_step + k * state_step] = packs[i][k];
    }
  } else if (state_step == 1) {
    for (int i = 0; i < count; ++i) store(packs[i], to + i * pack_step);
  } else if (pack_step == 1) {
    inBlocks<kShortWidth, N>(
        count, [&](int i) FAST_LAMBDA { storeTransposed(packs + i, to + i, state_step); }, one);
  } else {
    for (int i = 0; i < count; ++i) one(i);
  }
}

template <int N>
FAST_INLINE void scatter(const Robot& robot, const Pack* from, const Lanes& lanes,
                         const Samples& to) {
  scatter<N>(from, jointsOf<N>(robot), lanes, to.data, to.joint_step, to.state_step);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
