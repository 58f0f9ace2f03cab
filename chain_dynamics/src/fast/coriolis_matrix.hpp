// SPDX-License-Identifier: Apache-2.0

/// @file
/// The Coriolis matrix on one structure: blocks of links from tip to root.
///
/// Included by the kernels' two sources only [pack.hpp]. Names as in
/// chain_dynamics/coriolis_matrix.hpp, which tells why this is C.

#pragma once

#include <type_traits>

#include "mass_flow.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// A link's velocity, and V x S of its joint.
template <typename V>
struct CoriolisLink {
  Vec<V> w, v;
  Vec<V> dw, dv;
};

/// From root to tip. The first joint's velocity is the only one that it needs.
template <typename S, typename V>
FAST_INLINE void velocitiesOf(const Robot& robot, const State<V>& state, CoriolisLink<V>* links) {
  Vec<V> w{};
  Vec<V> v{};
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    if (i != 0) {
      constexpr Twist kTwist = S::twist(decltype(i)());
      const Turn<V> t{state.c[i], state.s[i], X};
      if (S::px(i)) addTo(v, {V{}, w.z * X.px, -w.y * X.px});
      if (S::py(i)) addTo(v, {-w.z * X.py, V{}, w.x * X.py});
      w = into<kTwist>(t, w);
      v = into<kTwist>(t, v);
    }
    if (prismatic) {
      addTo(v, {w.y * state.q[i], -w.x * state.q[i], state.qd[i]});
      links[i] = {w, v, Vec<V>{}, {w.y, -w.x, V{}}};
    } else {
      w.z += state.qd[i];
      links[i] = {w, v, {w.y, -w.x, V{}}, {v.y, -v.x, V{}}};
    }
  });
}

/// Forces of joint i that go on to the joints before.
template <typename V>
struct CoriolisForces {
  Wrench<V> inertial;  ///< I_c S
  Wrench<V> own;       ///< what a unit of joint i's velocity needs
  Vec<V> turned;       ///< joint i's force for a turn of what is before it: a moment without force

  template <typename S, typename I>
  FAST_INLINE void carryAll(I i, const Robot& robot, const State<V>& state) {
    carry<S>(i, robot, state, inertial);
    carry<S>(i, robot, state, own);
    constexpr Twist kTwist = S::twist(I());
    turned = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], robot.placements[i]}, turned);
  }
  /// C(j, i) and C(i, j): along the axis of joint j, and what its V x S moves.
  FAST_INLINE V column(bool sliding) const { return sliding ? own.f.z : own.n.z; }
  FAST_INLINE V row(bool sliding, const CoriolisLink<V>& link) const {
    const V power = link.dw.x * inertial.n.x + link.dw.y * inertial.n.y + link.dv.x * inertial.f.x +
                    link.dv.y * inertial.f.y;
    return sliding ? power : turned.z + power;
  }
};

/// The same of one state, side by side: inertial, own, turned.
struct FourCoriolisForces {
  Wrench<Four> F;

  FAST_INLINE explicit FourCoriolisForces(const CoriolisForces<double>& r)
      : F{{Four{r.inertial.f.x, r.own.f.x}, Four{r.inertial.f.y, r.own.f.y},
           Four{r.inertial.f.z, r.own.f.z}},
          {Four{r.inertial.n.x, r.own.n.x, r.turned.x}, Four{r.inertial.n.y, r.own.n.y, r.turned.y},
           Four{r.inertial.n.z, r.own.n.z, r.turned.z}}} {}

  template <typename S, typename I>
  FAST_INLINE void carryAll(I i, const Robot& robot, const State<double>& state) {
    carry<S>(i, robot, state, F);
  }
  FAST_INLINE double column(bool sliding) const { return (sliding ? F.f.z : F.n.z)[1]; }
  FAST_INLINE double row(bool sliding, const CoriolisLink<double>& link) const {
    const double power =
        link.dw.x * F.n.x[0] + link.dw.y * F.n.y[0] + link.dv.x * F.f.x[0] + link.dv.y * F.f.y[0];
    return sliding ? power : F.n.z[2] + power;
  }
};

template <typename V>
struct CarriedCoriolis {
  using Type = CoriolisForces<V>;
};
template <>
struct CarriedCoriolis<double> {  // registers of two numbers gain nothing
  using Type = std::conditional_t<kShortWidth == 4, FourCoriolisForces, CoriolisForces<double>>;
};

/// The forces of joint i; `m` is the mass of what it moves, if Massive.
template <bool Massive, typename V>
FAST_INLINE CoriolisForces<V> coriolisForces(bool prismatic, const Composite<V>& I, double m,
                                             const Flow<V>& flow, const CoriolisLink<V>& link) {
  const V zero{};
  CoriolisForces<V> forces;
  forces.own = timesAcross<Massive>(I, m, link.dw, link.dv);
  if (prismatic) {
    // nothing turns: no Coriolis' force but by what turns before
    forces.inertial = {{zero, zero, m + zero}, {I.mc.y, -I.mc.x, zero}};
    forces.turned = {flow.p.y, -flow.p.x, zero};
    return forces;
  }
  // Coriolis' force w x p and moment trace(Q) w - Q w of w = z, and of z' (trace(Q) - Q)
  const V xx_yy = flow.x.x + flow.y.y;
  addTo(forces.own.f, {-flow.p.y, flow.p.x, zero});
  addTo(forces.own.n, {-flow.z.x, -flow.z.y, xx_yy});
  forces.inertial = {{-I.mc.y, I.mc.x, zero}, {-I.xz, -I.yz, I.xx + I.yy}};
  forces.turned = {-flow.x.z, -flow.y.z, xx_yy};
  return forces;
}

/// Rows first .. joints - 1 with one set of parameters; entry (i, j) at C[i + j outer_step].
template <typename S, typename V, typename First>
FAST_INLINE void coriolisOfMotion(const Robot& robot, const State<V>& state,
                                  const CoriolisLink<V>* links, const Body* bodies, First first,
                                  V* C, std::ptrdiff_t outer_step) {
  Composite<V> I;
  Flow<V> flow;
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const Body& body = bodies[i];
    const bool prismatic = S::kMixed && robot.placements[i].prismatic;
    const double m = S::kMixed ? body.mass_beyond : 0.0;  // joints that turn leave none
    flow.add(prismatic, body, links[i].w, links[i].v);
    if (i == 0) {
      C[0] = prismatic ? V{} : flow.x.x + flow.y.y;  // nothing is before it
      return;
    }
    I.add(body);

    typename CarriedCoriolis<V>::Type F(coriolisForces<S::kMixed>(prismatic, I, m, flow, links[i]));
    C[i + i * outer_step] = F.column(prismatic);
    S::backwardsFrom(i, [&](auto j) FAST_LAMBDA {
      F.template carryAll<S>(j, robot, state);
      const bool sliding = S::kMixed && robot.placements[j - 1].prismatic;
      C[i + (j - 1) * outer_step] = F.row(sliding, links[j - 1]);
      if (j > first) C[(j - 1) + i * outer_step] = F.column(sliding);
    });
    if (i == first) return;

    // on to the parent link
    carry<S>(i, robot, state, m, I);
    flow.template carry<S>(i, robot, state);
  });
}

/// C of a robot with one set of parameters for all rows.
template <typename S, typename V>
void coriolisMatrix(const Robot& robot, const State<V>& state, V* C, std::ptrdiff_t to_column) {
  // packs stand side by side; that makes their places constants
  const std::ptrdiff_t outer_step = sizeof(V) == sizeof(double) ? to_column : S::count(robot);
  CoriolisLink<V> links[S::kJoints];
  velocitiesOf<S>(robot, state, links);
  coriolisOfMotion<S>(robot, state, links, robot.bodies, Constant<0>(), C, outer_step);
}

/// The same with a set for each row: each overwrites all rows but those before its own.
template <typename S, typename V>
void coriolisMatrixByRow(const Robot& robot, const State<V>& state, V* C,
                         std::ptrdiff_t outer_step) {
  CoriolisLink<V> links[S::kJoints];
  velocitiesOf<S>(robot, state, links);
  for (int set = 0; set < robot.joints; ++set) {
    coriolisOfMotion<S>(robot, state, links, robot.rows[set], set, C, outer_step);
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
