// SPDX-License-Identifier: Apache-2.0

/// @file
/// The Coriolis matrix on one structure: half of the torques' derivative by the velocities
/// [torque_derivatives.hpp], without what only the other derivatives need.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>

#include "torque_derivatives.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Where the entries go: (i, j) at i + j outer_step.
template <typename V>
struct CoriolisEntries {
  static constexpr bool kByTravel = false;
  static constexpr double kFlow = 1;  ///< half of what the derivative has

  V* C;
  std::ptrdiff_t outer_step;

  FAST_INLINE void set(int row, int column, const V&, const V& half_by_qd, const V&) const {
    C[row + column * outer_step] = half_by_qd;
  }
};

/// From root to tip. The first joint's velocity is the only one that it needs.
template <typename S, typename V>
FAST_INLINE void setVelocities(const Robot& robot, const State<V>& state, MovingLink<V>* links) {
  Vec<V> w{};
  Vec<V> v{};
  S::forwards(robot, [&](auto i) FAST_LAMBDA { setVelocity<S>(i, robot, state, w, v, links[i]); });
}

/// C of a robot with one set of parameters for all rows.
template <typename S, typename V>
void coriolisMatrix(const Robot& robot, const State<V>& state, V* C, std::ptrdiff_t to_column) {
  // packs stand side by side; that makes their places constants
  const std::ptrdiff_t outer_step = sizeof(V) == sizeof(double) ? to_column : S::count(robot);
  MovingLink<V> links[S::kJoints];
  setVelocities<S>(robot, state, links);
  derivativesOfMotion<S>(robot, state, links, robot.bodies, Constant<0>(),
                         CoriolisEntries<V>{C, outer_step});
}

/// The same with a set for each row: each overwrites all rows but those before its own.
template <typename S, typename V>
void coriolisMatrixByRow(const Robot& robot, const State<V>& state, V* C,
                         std::ptrdiff_t outer_step) {
  MovingLink<V> links[S::kJoints];
  setVelocities<S>(robot, state, links);
  for (int set = 0; set < robot.joints; ++set) {
    derivativesOfMotion<S>(robot, state, links, robot.rows[set], set,
                           CoriolisEntries<V>{C, outer_step});
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
