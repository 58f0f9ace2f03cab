// SPDX-License-Identifier: Apache-2.0

/// @file
/// The tip's pose and Jacobian of many states, a pack at a time.
///
/// Included by many_kernels.cpp only [pack.hpp].

#pragma once

#include <cstddef>

#include "many_states.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

void tipPoseBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices R,
                  Samples p) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack rotation[9];
    Pack position[3];
    x.readPositions(robot, q, lanes, FirstJoint::kNeeded);
    tipKinematicsOf<Pack>(structure).pose(robot, x.state(), rotation, position);
    scatterColumns<3>(rotation, 3, 3, lanes, R);
    scatter<3>(position, 3, lanes, p.data, p.joint_step, p.state_step);
  });
}

/// Packs of the entries of 6 x n matrices, (i, j) at i + 6 j, to the matrices of each state.
FAST_INLINE void scatterJacobian(const Pack* entries, int n, const Lanes& lanes,
                                 const Matrices& to) {
  if (to.column_step == 1) {
    for (int i = 0; i < 6; ++i) {
      Pack row[kMaxJoints];
      for (int j = 0; j < n; ++j) row[j] = entries[i + 6 * j];
      scatter(row, n, lanes, to.data + i * to.row_step, 1, to.state_step);
    }
  } else {
    scatterColumns<6>(entries, 6, n, lanes, to);
  }
}

void tipJacobianBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                      Matrices J) {
  const int n = robot.joints;
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack entries[6 * kMaxJoints];
    x.readPositions(robot, q, lanes, FirstJoint::kNeeded);
    tipKinematicsOf<Pack>(structure).jacobian(robot, x.state(), JacobianEntries<Pack>{entries, 6});
    scatterJacobian(entries, n, lanes, J);
  });
}

void tipJacobianDerivativeBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                                Samples qd, Matrices dJ) {
  const int n = robot.joints;
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack entries[6 * kMaxJoints];
    gather(robot, qd, lanes, x.qd);
    x.readPositions(robot, q, lanes, FirstJoint::kNeeded);
    tipKinematicsOf<Pack>(structure).jacobian_derivative(robot, x.state(),
                                                         JacobianEntries<Pack>{entries, 6});
    scatterJacobian(entries, n, lanes, dJ);
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
