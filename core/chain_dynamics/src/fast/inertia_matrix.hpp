// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inertia matrix on one structure: composite bodies, from tip to root.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>

#include "link_motion.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// A link and all after it as one body, in the link's frame.
template <typename P>
struct Composite {
  Vec<P> mc{};
  P xx{}, xy{}, xz{}, yy{}, yz{}, zz{};

  template <typename B>
  FAST_INLINE void add(const B& b) {
    mc.x += b.mcx;
    mc.y += b.mcy;
    mc.z += b.mcz;
    xx += b.Sxx;
    xy += b.Sxy;
    xz += b.Sxz;
    yy += b.Syy;
    yz += b.Syz;
  }
};

/// S' = R S R' for a turn about z.
template <typename V, typename P>
FAST_INLINE void turn(const V& c, const V& s, Composite<P>& I) {
  const P row_x = c * I.xx - s * I.xy;
  const P row_y = c * I.xy - s * I.yy;
  const P trace = I.xx + I.yy;
  I.xx = c * row_x - s * row_y;
  I.xy = s * row_x + c * row_y;
  I.yy = trace - I.xx;
  const P xz = c * I.xz - s * I.yz;
  I.yz = s * I.xz + c * I.yz;
  I.xz = xz;
}

/// S' = R S R' for a twist about x.
template <Twist Kind, typename P>
FAST_INLINE void twist(const Placement& X, Composite<P>& I) {
  const Composite<P> J = I;
  if constexpr (Kind == Twist::kRight) {
    I.xy = -J.xz;
    I.xz = J.xy;
    I.yy = J.zz;
    I.yz = -J.yz;
    I.zz = J.yy;
  } else if constexpr (Kind != Twist::kNone) {
    const double c = X.cos_twist;
    const double s = Kind == Twist::kAlmostRight ? 1.0 : X.sin_twist;
    I.xy = c * J.xy - s * J.xz;
    I.xz = s * J.xy + c * J.xz;
    const P row_y = c * J.yy - s * J.yz;
    const P row_z = c * J.yz - s * J.zz;
    I.yy = c * row_y - s * row_z;
    I.yz = s * row_y + c * row_z;
    I.zz = (J.yy + J.zz) - I.yy;
  }
}

/// S' = S + mc p' + p mc' + m p p', mc' = mc + m p. m may be a number known to be zero.
template <typename S, typename P, typename M>
FAST_INLINE void shift(int i, const Placement& X, const M& m, Composite<P>& I) {
  Vec<P> h = I.mc;
  if (S::kMixed) {
    h.x += m * (0.5 * X.px);
    h.y += m * (0.5 * X.py);
    I.mc.x += m * X.px;
    I.mc.y += m * X.py;
  }
  if (S::px(i)) {
    I.xx += (2.0 * X.px) * h.x;
    I.xy += X.px * h.y;
    I.xz += X.px * h.z;
  }
  if (S::py(i)) {
    I.xy += X.py * h.x;
    I.yy += (2.0 * X.py) * h.y;
    I.yz += X.py * h.z;
  }
}

/// On to the parent link of joint i; m is the mass of the body.
template <typename S, typename I, typename V, typename P, typename M>
FAST_INLINE void carry(I i, const Robot& robot, const State<V>& state, const M& m,
                       Composite<P>& body) {
  const Placement& X = robot.placements[i];
  if (S::kMixed && X.prismatic) {
    // moved along z by q
    const P h = body.mc.z + (0.5 * m) * state.q[i];
    body.xz += state.q[i] * body.mc.x;
    body.yz += state.q[i] * body.mc.y;
    body.zz += 2.0 * (state.q[i] * h);
    body.mc.z += m * state.q[i];
  }
  constexpr Twist kTwist = S::twist(I());
  turn(state.c[i], state.s[i], body);
  twist<kTwist>(X, body);
  body.mc = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], X}, body.mc);
  shift<S>(i, X, m, body);
}

/// The composite bodies from tip to `first`, and the forces at each joint j <= i that accelerate
/// joint i by one; each(i, j, H_ij).
template <typename S, typename V, typename P, typename First, typename BodyOf, typename Each>
FAST_INLINE void forEachInertia(const Robot& robot, const State<V>& state, First first,
                                const BodyOf& body_of, const Each& each) {
  Composite<P> I;
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const auto& body = body_of(i);
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    I.add(body);

    // F = I S
    const P zero{};
    Wrench<P> F{{-I.mc.y, I.mc.x, zero}, {-I.xz, -I.yz, I.xx + I.yy}};
    if (prismatic) F = {{zero, zero, body.mass_beyond + zero}, {I.mc.y, -I.mc.x, zero}};
    each(i, i, (prismatic ? F.f.z : F.n.z) + X.rotor_inertia);

    // on to the parent link; first, since what follows can wait
    if (i != first) carry<S>(i, robot, state, body.mass_beyond, I);

    // H_ji = S_j' F in the frames of the joints before
    S::backwardsFrom(i, [&](auto j) FAST_LAMBDA {
      carry<S>(j, robot, state, F);
      each(i, j - 1, S::kMixed && robot.placements[j - 1].prismatic ? F.f.z : F.n.z);
    });
  });
}

/// Where the entries of the inertia matrix go.
template <typename V>
struct Entries {
  V* data;
  std::ptrdiff_t row_step, column_step;

  FAST_INLINE void set(int row, int column, const V& value) const {
    data[row * row_step + column * column_step] = value;
  }
};

/// Inertia matrix with a set of parameters for each row.
template <typename S, typename V>
FAST_APART void inertiaByRow(const Robot& robot, const State<V>& state, const Entries<V>& H) {
  using R = Rows<V>;
  using P = typename R::P;
  S::template inSteps<R::kCount>(robot, [&](auto first) FAST_LAMBDA {
    const int end = first + R::kCount;
    forEachInertia<S, V, P>(
        robot, state, first,
        [&](auto i) FAST_LAMBDA -> decltype(auto) { return R::body(robot, i, first); },
        [&](auto i, auto j, const P& value) FAST_LAMBDA {
          if (i < end) H.set(i, j, R::number(value, i - first));
          if (first <= j && j < end && i != j) H.set(j, i, R::number(value, j - first));
        });
  });
}

/// The same; with one set of parameters for all rows, if the robot has no more.
template <typename S, typename V>
void inertia(const Robot& robot, const State<V>& state, const Entries<V>& to) {
  if constexpr (S::kRows) {
    if (robot.rows != nullptr) return inertiaByRow<S>(robot, state, to);
  }
  // packs stand side by side; that makes their places constants
  const Entries<V> H = sizeof(V) == sizeof(double) ? to : Entries<V>{to.data, 1, S::count(robot)};
  forEachInertia<S, V, V>(
      robot, state, Constant<0>(),
      [&](auto i) FAST_LAMBDA -> const Body& { return robot.bodies[i]; },
      [&](auto i, auto j, const V& value) FAST_LAMBDA {
        H.set(i, j, value);
        if (i != j) H.set(j, i, value);
      });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
