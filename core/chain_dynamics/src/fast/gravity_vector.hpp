// SPDX-License-Identifier: Apache-2.0

/// @file
/// Gravity torques on one structure.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "link_motion.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// First moment of all bodies distal to joint i, on to the parent link; m is their mass.
template <typename S, typename I, typename V, typename P, typename M>
FAST_INLINE void carryPoint(I i, const Robot& robot, const State<V>& state, const M& m,
                            Vec<P>& mc) {
  const Placement& X = robot.placements[i];
  if (S::kMixed && X.prismatic) mc.z += m * state.q[i];
  constexpr Twist kTwist = S::twist(I());
  mc = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], X}, mc);
  if (S::kMixed) {  // joints that turn leave no mass
    mc.x += m * X.px;
    mc.y += m * X.py;
  }
}

/// Gravity in the links' frames, then the bodies distal to each joint as one heavy point, from tip to
/// `first`; each(i, torque).
template <typename S, typename V, typename P, typename First, typename BodyOf, typename Each>
FAST_INLINE void forEachGravity(const Robot& robot, const State<V>& state, First first,
                                const Vec<V>* a, const BodyOf& body_of, const Each& each) {
  Vec<P> mc{};
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const auto& body = body_of(i);
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    mc.x += body.mcx;
    mc.y += body.mcy;
    if (S::kMixed) mc.z += body.mcz;
    const P force = prismatic ? body.mass_beyond * a[i].z : mc.x * a[i].y - mc.y * a[i].x;
    if (i != first) carryPoint<S>(i, robot, state, body.mass_beyond, mc);
    each(i, force);  // last: what it writes may stand where the state does
  });
}

template <typename S, typename V>
FAST_INLINE void gravityInLinks(const Robot& robot, const State<V>& state, Vec<V>* a) {
  const V zero{};
  Vec<V> in_link{robot.root[0] + zero, robot.root[1] + zero, robot.root[2] + zero};
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    const Turn<V> t{state.c[i], state.s[i], robot.placements[i]};
    if (i == 0) {
      in_link = into<Twist::kNone>(t, in_link);
    } else {
      constexpr Twist kTwist = S::twist(decltype(i)());
      in_link = into<kTwist>(t, in_link);
    }
    a[i] = in_link;
  });
}

/// Gravity torques with a set of parameters for each row.
template <typename S, typename V>
FAST_APART void gravityByRow(const Robot& robot, const State<V>& state, V* g) {
  using R = Rows<V>;
  using P = typename R::P;
  Vec<V> a[S::kJoints];
  gravityInLinks<S>(robot, state, a);
  S::template inSteps<R::kCount>(robot, [&](auto first) FAST_LAMBDA {
    forEachGravity<S, V, P>(
        robot, state, first, a,
        [&](auto i) FAST_LAMBDA -> decltype(auto) { return R::body(robot, i, first); },
        [&](auto i, const P& torque) FAST_LAMBDA {
          if (i < first + R::kCount) g[i] = R::number(torque, i - first);
        });
  });
}

/// The same; with one set of parameters for all rows, if the robot has one: its only one, or
/// gravity's own.
template <typename S, typename V>
void gravity(const Robot& robot, const State<V>& state, V* g) {
  if constexpr (S::kRows) {
    if (robot.rows != nullptr && robot.gravity_bodies == nullptr) {
      return gravityByRow<S>(robot, state, g);
    }
  }
  const Body* bodies = robot.gravity_bodies != nullptr ? robot.gravity_bodies : robot.bodies;
  Vec<V> a[S::kJoints];
  gravityInLinks<S>(robot, state, a);
  forEachGravity<S, V, V>(
      robot, state, Constant<0>(), a, [&](auto i) FAST_LAMBDA -> const Body& { return bodies[i]; },
      [&](auto i, const V& torque) FAST_LAMBDA { g[i] = torque; });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
