// SPDX-License-Identifier: Apache-2.0

/// @file
/// What solvers compute of many states, a pack at a time.
///
/// N is the number of joints where the compiler is to know it, or zero: worth up to 4 % for one number
/// per joint, nothing for matrices.
///
/// Included by many_kernels.cpp only [pack.hpp].

#pragma once

#include <cstddef>

#include "friction.hpp"
#include "lanes.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Memory of one pack of states of at most so many joints.
template <int Most = kMaxJoints>
struct PackOfStates {
  Pack q[Most], c[Most], s[Most], qd[Most], qdd[Most];
  State<Pack> state() const { return {c, s, q, qd, qdd}; }

  template <int N = 0>
  FAST_INLINE void readPositions(const Robot& robot, const Samples& from, const Lanes& lanes,
                                 FirstJoint use) {
    gather<N>(robot, from, lanes, q);
    turnsOfPack(robot, q, use, c, s);
  }
  template <int N = 0>
  FAST_INLINE void read(const Robot& robot, const Samples& from_q, const Samples& from_qd,
                        const Samples& from_qdd, const Lanes& lanes) {
    gather<N>(robot, from_qd, lanes, qd);
    gather<N>(robot, from_qdd, lanes, qdd);
    readPositions<N>(robot, from_q, lanes, FirstJoint::kForGravity);
  }
  template <int N>
  FAST_INLINE void readAtRest(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather<N>(robot, from, lanes, qd);
    for (int i = 0; i < jointsOf<N>(robot); ++i) qdd[i] = Pack{};
  }
};

/// Packs of a matrix's columns, one after the other, to the matrices of each state.
template <int Rows = 0>
FAST_INLINE void scatterColumns(const Pack* entries, int rows, int columns, const Lanes& lanes,
                                const Matrices& to) {
  if (to.row_step == 1 && to.column_step == rows) {
    scatter(entries, rows * columns, lanes, to.data, 1, to.state_step);
    return;
  }
  for (int j = 0; j < columns; ++j) {
    scatter<Rows>(entries + std::ptrdiff_t{rows} * j, rows, lanes, to.data + j * to.column_step,
                  to.row_step, to.state_step);
  }
}

/// The same matrices, or where rows stand side by side their transposes.
FAST_INLINE Matrices sideBySide(const Matrices& H) {
  return H.column_step != 1 ? H : Matrices{H.data, 1, H.row_step, H.state_step};
}

FAST_INLINE void inertiaOfPack(const Robot& robot, int structure, const State<Pack>& state,
                               const Lanes& lanes, const Matrices& H) {
  const int n = robot.joints;
  const bool columns = H.column_step != 1;
  Pack entries[kPackedMatrixJoints * kPackedMatrixJoints];
  recursionsOf<Pack>(structure).inertia(robot, state,
                                        Entries<Pack>{entries, columns ? 1 : n, columns ? n : 1});
  scatterColumns(entries, n, n, lanes, sideBySide(H));
}

template <int N>
void torquesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples qdd, Samples tau) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack result[kMaxJoints];
    x.read<N>(robot, q, qd, qdd, lanes);
    torquesOf(robot, structure, x.state(), result);
    if (robot.changing_steps) {
      addChangingFriction(robot, structure, x.state(), 1.0, result);
    } else if (robot.friction != nullptr) {
      for (int i = 0; i < jointsOf<N>(robot); ++i) result[i] += frictionOfPack(robot, i, x.qd[i]);
    }
    scatter<N>(robot, result, lanes, tau);
  });
}

template <int N>
void coriolisBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples c) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack result[kMaxJoints];
    x.readAtRest<N>(robot, qd, lanes);
    x.readPositions<N>(robot, q, lanes, FirstJoint::kUnused);
    recursionsOf<Pack>(structure).torques(robot, x.state(), kNoGravity, result);
    scatter<N>(robot, result, lanes, c);
  });
}

template <int N>
void gravityBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack result[kMaxJoints];
    x.readPositions<N>(robot, q, lanes, FirstJoint::kForGravity);
    recursionsOf<Pack>(structure).gravity(robot, x.state(), result);
    scatter<N>(robot, result, lanes, g);
  });
}

void inertiaBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices H) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    x.readPositions(robot, q, lanes, FirstJoint::kUnused);
    inertiaOfPack(robot, structure, x.state(), lanes, H);
  });
}

template <int N>
void componentsBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                     Samples qd, Matrices H, Samples c, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack result[kMaxJoints];
    x.readAtRest<N>(robot, qd, lanes);
    x.readPositions<N>(robot, q, lanes, FirstJoint::kForGravity);
    if (H.data != nullptr) inertiaOfPack(robot, structure, x.state(), lanes, H);
    recursionsOf<Pack>(structure).gravity(robot, x.state(), result);
    scatter<N>(robot, result, lanes, g);
    leaveOutFirst(x.c, x.s);
    recursionsOf<Pack>(structure).torques(robot, x.state(), kNoGravity, result);
    scatter<N>(robot, result, lanes, c);
  });
}

template <int N>
void changingFrictionBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                           Samples qd, Samples f) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack result[kJointSpace];
    gather<N>(robot, qd, lanes, x.qd);
    if (robot.load_friction) x.readPositions<N>(robot, q, lanes, FirstJoint::kForGravity);
    changingFriction(robot, structure, x.state(), result);
    scatter<N>(robot, result, lanes, f);
  });
}

template <int N>
void frictionBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples f) {
  if (robot.changing_steps) return changingFrictionBatch<N>(robot, structure, states, q, qd, f);
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
