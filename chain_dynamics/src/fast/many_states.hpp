// SPDX-License-Identifier: Apache-2.0

/// @file
/// What is computed of many states, a pack at a time.
///
/// N is the number of joints where the compiler is to know it, or zero.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include "friction.hpp"
#include "lanes.hpp"
#include "one_state.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Memory of one pack of states.
struct PackOfStates {
  Pack q[kMaxJoints], c[kMaxJoints], s[kMaxJoints], qd[kMaxJoints], qdd[kMaxJoints];
  State<Pack> state() const { return {c, s, q, qd, qdd}; }

  template <int N>
  FAST_INLINE void readPositions(const Robot& robot, const Samples& from, const Lanes& lanes,
                                 bool gravity) {
    gather<N>(robot, from, lanes, q);
    turnsOfPack(robot, q, gravity, c, s);
  }
  template <int N>
  FAST_INLINE void readAtRest(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather<N>(robot, from, lanes, qd);
    for (int i = 0; i < jointsOf<N>(robot); ++i) qdd[i] = Pack{};
  }
};

/// Longest chain whose matrices of one pack of states fit on the stack.
constexpr int kPackedMatrixJoints = 16;

template <int N>
FAST_INLINE void inertiaOfPack(const Robot& robot, int structure, const State<Pack>& state,
                               const Lanes& lanes, const Matrices& H) {
  const int n = jointsOf<N>(robot);
  Pack entries[kPackedMatrixJoints * kPackedMatrixJoints];

  // columns in turn, or rows, whichever stand side by side
  const bool columns = H.column_step != 1;
  const std::ptrdiff_t major_step = columns ? H.column_step : H.row_step;
  const std::ptrdiff_t minor_step = columns ? H.row_step : 1;
  recursionsOf<Pack>(robot, structure)
      .inertia(robot, state, Entries<Pack>{entries, columns ? 1 : n, columns ? n : 1});
  if (minor_step == 1 && major_step == n) {
    scatter<N * N>(entries, n * n, lanes, H.data, 1, H.state_step);
    return;
  }
  for (int j = 0; j < n; ++j) {
    scatter<N>(entries + std::ptrdiff_t{j} * n, n, lanes, H.data + j * major_step, minor_step,
               H.state_step);
  }
}

// For longer chains.
void inertiaOneByOne(const Robot& robot, int structure, std::ptrdiff_t states, const Samples& q,
                     Matrices H) {
  for (std::ptrdiff_t k = 0; k < states; ++k) {
    double position[kMaxJoints];
    for (int i = 0; i < robot.joints; ++i) {
      position[i] = q.data[i * q.joint_step + k * q.state_step];
    }
    inertiaOfState(robot, structure, position, H);
    H.data += H.state_step;
  }
}

template <int N>
void torquesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples qdd, Samples tau) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    gather<N>(robot, qd, lanes, x.qd);
    gather<N>(robot, qdd, lanes, x.qdd);
    x.readPositions<N>(robot, q, lanes, true);
    torquesOf(robot, structure, x.state(), result);
    if (robot.friction != nullptr) {
      for (int i = 0; i < jointsOf<N>(robot); ++i) result[i] += frictionOfPack(robot, i, x.qd[i]);
    }
    scatter<N>(robot, result, lanes, tau);
  });
}

template <int N>
void coriolisBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples c) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readAtRest<N>(robot, qd, lanes);
    x.readPositions<N>(robot, q, lanes, false);
    coriolisOf(robot, structure, x.state(), result);
    scatter<N>(robot, result, lanes, c);
  });
}

template <int N>
void gravityBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readPositions<N>(robot, q, lanes, true);
    gravityOf(robot, structure, x.state(), result);
    scatter<N>(robot, result, lanes, g);
  });
}

template <int N>
void inertiaBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices H) {
  if (robot.joints > kPackedMatrixJoints) return inertiaOneByOne(robot, structure, states, q, H);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    x.readPositions<N>(robot, q, lanes, false);
    inertiaOfPack<N>(robot, structure, x.state(), lanes, H);
  });
}

template <int N>
void componentsBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                     Samples qd, Matrices H, Samples c, Samples g) {
  const bool packed = robot.joints <= kPackedMatrixJoints;
  if (!packed) inertiaOneByOne(robot, structure, states, q, H);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readAtRest<N>(robot, qd, lanes);
    x.readPositions<N>(robot, q, lanes, true);
    if (packed) inertiaOfPack<N>(robot, structure, x.state(), lanes, H);
    gravityOf(robot, structure, x.state(), result);
    scatter<N>(robot, result, lanes, g);
    leaveOutFirst(x.c, x.s);
    coriolisOf(robot, structure, x.state(), result);
    scatter<N>(robot, result, lanes, c);
  });
}

template <int N>
void frictionBatch(const Robot& robot, std::ptrdiff_t states, Samples qd, Samples f) {
  forEachPack(states, [&](const Lanes& lanes) {
    Pack x[kMaxJoints];
    gather<N>(robot, qd, lanes, x);
    for (int i = 0; i < jointsOf<N>(robot); ++i) x[i] = frictionOfPack(robot, i, x[i]);
    scatter<N>(robot, x, lanes, f);
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
