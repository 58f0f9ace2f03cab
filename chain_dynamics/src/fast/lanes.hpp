// SPDX-License-Identifier: Apache-2.0

/// @file
/// States as lanes: from and to memory of any layout.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include "pack.hpp"
#include "robot.hpp"

namespace chain_dynamics::fast {
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

// The common cases have no branch per number: a full pack of states that stand apart, or side by
// side.
FAST_INLINE void gather(const Robot& robot, const Samples& from, const Lanes& lanes, Pack* to) {
  const std::ptrdiff_t step = from.state_step;
  const double* const first = from.data + lanes.first * step;
  const int n = robot.joints;
  if (lanes.count < kWidth) {
    for (int i = 0; i < n; ++i) {
      for (int lane = 0; lane < kWidth; ++lane) {
        to[i][lane] = from.data[lanes[lane] * step + i * from.joint_step];
      }
    }
  } else if (step == 1) {
    for (int i = 0; i < n; ++i) to[i] = load<Pack>(first + i * from.joint_step);
  } else {
    for (int i = 0; i < n; ++i) to[i] = loadSteps(first + i * from.joint_step, step);
  }
}

// packs[i] to the numbers of each state at to[i pack_step + state state_step].
FAST_INLINE void scatter(const Pack* packs, int count, const Lanes& lanes, double* to,
                         std::ptrdiff_t pack_step, std::ptrdiff_t state_step) {
  to += lanes.first * state_step;
  if (lanes.count < kWidth) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < lanes.count; ++k) to[i * pack_step + k * state_step] = packs[i][k];
    }
  } else if (state_step == 1) {
    for (int i = 0; i < count; ++i) store(packs[i], to + i * pack_step);
  } else {
    for (int i = 0; i < count; ++i) storeSteps(packs[i], to + i * pack_step, state_step);
  }
}

FAST_INLINE void scatter(const Robot& robot, const Pack* from, const Lanes& lanes,
                         const Samples& to) {
  scatter(from, robot.joints, lanes, to.data, to.joint_step, to.state_step);
}

}  // namespace
}  // namespace chain_dynamics::fast
