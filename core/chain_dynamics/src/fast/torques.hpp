// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joint torques on one structure: Newton and Euler, from tip to root.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "link_motion.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// The forces through the joints from tip to `first`, given what each link needs for itself;
/// each(i, force along or moment about the axis of joint i).
template <typename S, typename V, typename P, typename First, typename Own, typename Each>
FAST_INLINE void forEachJointForce(const Robot& robot, const State<V>& state, First first,
                                   const Own& own, const Each& each) {
  Wrench<P> W{};
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const Wrench<P> link = own(i);
    addTo(W.f, link.f);
    addTo(W.n, link.n);
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    const P force = prismatic ? W.f.z : W.n.z;
    if (i != first) carry<S>(i, robot, state, W);
    each(i, force);  // last: what it writes may stand where the state does
  });
}

template <typename S, typename V, typename B>
FAST_INLINE auto wrenchOfLink(const Robot& robot, int i, const LinkMotion<V>& U, const B& body) {
  if (S::kMixed && robot.placements[i].prismatic) return wrenchOf<true>(U, body);
  return wrenchOf<false>(U, body);
}

/// tau = H qdd + C qd, and with root the gravity torques, with a set of parameters for each row.
template <typename S, typename V>
FAST_APART void torquesByRow(const Robot& robot, const State<V>& state, const double* root,
                             V* tau) {
  using R = Rows<V>;
  using P = typename R::P;
  LinkMotion<V> motion[S::kJoints];
  forEachMotion<S>(robot, state, root,
                   [&](auto i, const LinkMotion<V>& U) FAST_LAMBDA { motion[i] = U; });
  S::template inSteps<R::kCount>(robot, [&](auto first) FAST_LAMBDA {
    forEachJointForce<S, V, P>(
        robot, state, first,
        [&](auto i)
            FAST_LAMBDA { return wrenchOfLink<S>(robot, i, motion[i], R::body(robot, i, first)); },
        [&](auto i, const P& force) FAST_LAMBDA {
          if (i < first + R::kCount) {
            tau[i] = R::number(force, i - first) + robot.placements[i].rotor_inertia * state.qdd[i];
          }
        });
  });
}

/// The same with one set of parameters for all rows.
template <typename S, typename V>
FAST_APART void torquesByBody(const Robot& robot, const State<V>& state, const double* root,
                              V* tau) {
  Wrench<V> own[S::kJoints];
  forEachMotion<S>(robot, state, root, [&](auto i, const LinkMotion<V>& U) FAST_LAMBDA {
    own[i] = wrenchOfLink<S>(robot, i, U, robot.bodies[i]);
  });
  forEachJointForce<S, V, V>(
      robot, state, Constant<0>(), [&](auto i) FAST_LAMBDA { return own[i]; },
      [&](auto i, const V& force)
          FAST_LAMBDA { tau[i] = force + robot.placements[i].rotor_inertia * state.qdd[i]; });
}

/// By row or by body, as the robot has its parameters: each has stack of its own only.
template <typename S, typename V>
void torquesByRowOrBody(const Robot& robot, const State<V>& state, const double* root, V* tau) {
  if (robot.rows != nullptr) return torquesByRow<S>(robot, state, root, tau);
  return torquesByBody<S>(robot, state, root, tau);
}

/// The function for robots of structure S.
template <typename S, typename V>
constexpr auto torques() {
  if constexpr (S::kRows) {
    return torquesByRowOrBody<S, V>;
  } else {
    return torquesByBody<S, V>;
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
