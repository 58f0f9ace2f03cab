// SPDX-License-Identifier: Apache-2.0

/// @file
/// Derivatives of the torques on one structure, H among them: blocks of links from tip to root.
///
/// Included by the kernels' two sources only [pack.hpp]. O(n^2), or once per row of parameters
/// [Carpentier and Mansard 2018, Robotics: Science and Systems; in this form Singh, Russell, Wensing
/// 2022, arXiv 2105.05102].
///
/// Turn joint j a little further. Link i after it, with all that hangs on it, goes along as one
/// block, and if the world went along too, nothing would change for joint i. But the world stays:
/// compared with the block, it is the *base* on which joint j stands that has got another motion.
/// The links feel that as an additional velocity and acceleration, the same motion for all of them:
///
///     by q_j:     dV = V x S,   dA = A x S + V x (V x S)          S: axis of joint j
///     by qd_j:    dV = S,       dA = 2 V x S                      V, A: motion of link j
///     by qdd_j:   dV = 0,       dA = S
///
/// What that costs in torque needs only sums over the links from i to the tip: their inertia I_c
/// for dA, and the flow of their mass for dV, whose effect is Coriolis' force [mass_flow.hpp]. A
/// joint j before the one that turns, i, has no such block. Its torque holds the same additional
/// force of the links after i, and the force F that was there before, which has turned along: S_i
/// x* F.

#pragma once

#include <cstddef>
#include <type_traits>

#include "gravity_vector.hpp"
#include "mass_flow.hpp"
#include "torques.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// What a unit of a joint's travel adds to the motion of all links after it.
template <typename V>
struct AxisRates {
  Vec<V> w, v;    ///< V x S
  Vec<V> dw, dv;  ///< A x S + V x (V x S)
};

/// A link's velocity (w, v); also its motion and its joint's dw, dv where they are asked for.
template <typename V>
struct MovingLink {
  Vec<V> w, v;
  AxisRates<V> rates;
  LinkMotion<V> U;
};

template <typename V>
FAST_INLINE Vec<V> acrossZ(const Vec<V>& v) {
  return {v.y, -v.x, V{}};
}

/// From the velocity (w, v) of the link before to that of link i.
template <typename S, typename I, typename V>
FAST_INLINE void setVelocity(I i, const Robot& robot, const State<V>& state, Vec<V>& w, Vec<V>& v,
                             MovingLink<V>& link) {
  const Placement& X = robot.placements[i];
  if (i != 0) {
    constexpr Twist kTwist = S::twist(I());
    const Turn<V> t{state.c[i], state.s[i], X};
    if (S::px(i)) addTo(v, {V{}, w.z * X.px, -w.y * X.px});
    if (S::py(i)) addTo(v, {-w.z * X.py, V{}, w.x * X.py});
    w = into<kTwist>(t, w);
    v = into<kTwist>(t, v);
  }
  if (S::kMixed && X.prismatic) {
    addTo(v, {w.y * state.q[i], -w.x * state.q[i], state.qd[i]});
    link.rates.w = Vec<V>{};
    link.rates.v = acrossZ(w);
  } else {
    w.z += state.qd[i];
    link.rates.w = acrossZ(w);
    link.rates.v = acrossZ(v);
  }
  link.w = w;
  link.v = v;
}

template <typename V>
FAST_INLINE Vec<V> times(double factor, const Vec<V>& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}

/// From root to tip, all numbers of each link.
template <typename S, typename V>
FAST_INLINE void moveLinks(const Robot& robot, const State<V>& state, const double* root,
                           MovingLink<V>* links) {
  Vec<V> w{};
  Vec<V> v{};
  forEachMotion<S>(robot, state, root, [&](auto i, const LinkMotion<V>& U) FAST_LAMBDA {
    MovingLink<V>& link = links[i];
    setVelocity<S>(i, robot, state, w, v, link);
    link.U = U;
    link.rates.dw = {U.xz, U.yz, U.zz};
    if (S::kMixed && robot.placements[i].prismatic) {
      link.rates.dv = link.rates.dw;
      link.rates.dw = Vec<V>{};
    } else {
      link.rates.dv = {U.a.y + 2.0 * (v.z * w.x), 2.0 * (v.z * w.y) - U.a.x,
                       -2.0 * (v.x * w.x + v.y * w.y)};
    }
  });
}

/// I_c (w, v). Mass counts if Massive.
template <bool Massive, typename V>
FAST_INLINE Wrench<V> timesMotion(const Composite<V>& I, double m, const Vec<V>& w,
                                  const Vec<V>& v) {
  Wrench<V> F = timesAcross<Massive>(I, m, w, v);
  addTo(F.f, {-(w.z * I.mc.y), w.z * I.mc.x, V{}});
  if constexpr (Massive) F.f.z += m * v.z;
  addTo(F.n, {I.mc.y * v.z - I.xz * w.z, -(I.mc.x * v.z) - I.yz * w.z, (I.xx + I.yy) * w.z});
  return F;
}

/// What joint i needs for, or does with, a small change: forces that go on to the joints before.
template <typename V>
struct ForceRates {
  Wrench<V> by_q, by_qd, by_qdd;  ///< of the force through joint i, by its own travel
  Vec<V> turned;  ///< joint i's torque by a turn of what is before it: a moment without force

  template <typename S, typename I>
  FAST_INLINE void carryAll(I i, const Robot& robot, const State<V>& state) {
    carry<S>(i, robot, state, by_q);
    carry<S>(i, robot, state, by_qd);
    carry<S>(i, robot, state, by_qdd);
    constexpr Twist kTwist = S::twist(I());
    turned = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], robot.placements[i]}, turned);
  }
  FAST_INLINE Wrench<V> inertial() const { return by_qdd; }
  FAST_INLINE Vec<V> coriolis() const { return turned; }
};

/// Along the axis of a joint.
template <typename V>
struct AxialRates {
  V by_q, by_qd, by_qdd, turned;
};

template <typename V>
FAST_INLINE AxialRates<V> along(bool sliding, const ForceRates<V>& F) {
  if (sliding) return {F.by_q.f.z, F.by_qd.f.z, F.by_qdd.f.z, V{}};
  return {F.by_q.n.z, F.by_qd.n.z, F.by_qdd.n.z, F.turned.z};
}

/// The same of one state, side by side.
struct FourForceRates {
  enum Lane { kByQ, kByQd, kByQdd, kTurned };

  Wrench<Four> F;

  FAST_INLINE explicit FourForceRates(const ForceRates<double>& r)
      : F{{Four{r.by_q.f.x, r.by_qd.f.x, r.by_qdd.f.x, 0},
           Four{r.by_q.f.y, r.by_qd.f.y, r.by_qdd.f.y, 0},
           Four{r.by_q.f.z, r.by_qd.f.z, r.by_qdd.f.z, 0}},
          {Four{r.by_q.n.x, r.by_qd.n.x, r.by_qdd.n.x, r.turned.x},
           Four{r.by_q.n.y, r.by_qd.n.y, r.by_qdd.n.y, r.turned.y},
           Four{r.by_q.n.z, r.by_qd.n.z, r.by_qdd.n.z, r.turned.z}}} {}

  template <typename S, typename I>
  FAST_INLINE void carryAll(I i, const Robot& robot, const State<double>& state) {
    carry<S>(i, robot, state, F);
  }
  FAST_INLINE Wrench<double> inertial() const {
    return {{F.f.x[kByQdd], F.f.y[kByQdd], F.f.z[kByQdd]},
            {F.n.x[kByQdd], F.n.y[kByQdd], F.n.z[kByQdd]}};
  }
  FAST_INLINE Vec<double> coriolis() const {
    return {F.n.x[kTurned], F.n.y[kTurned], F.n.z[kTurned]};
  }
};

FAST_INLINE AxialRates<double> along(bool sliding, const FourForceRates& rates) {
  const Four& force = sliding ? rates.F.f.z : rates.F.n.z;
  return {force[FourForceRates::kByQ], force[FourForceRates::kByQd], force[FourForceRates::kByQdd],
          force[FourForceRates::kTurned]};
}

template <typename V, bool ByTravel>
struct CarriedOf {
  using Type = ForceRates<V>;
};
template <bool ByTravel>
struct CarriedOf<double, ByTravel> {  // without travel, registers of two numbers gain nothing
  using Type = std::conditional_t<ByTravel || kShortWidth == 4, FourForceRates, ForceRates<double>>;
};

/// What joint i needs for its own travel. `force` is what goes through it, `m` the mass of what it
/// moves, if Massive; `flow` is twice the flow of that mass.
template <bool Massive, typename V>
FAST_INLINE Wrench<V> forceByTravel(bool prismatic, const Composite<V>& I, double m,
                                    const Flow<V>& flow, const Wrench<V>& force,
                                    const AxisRates<V>& r) {
  const Vec<V>& f = force.f;
  const Vec<V>& n = force.n;
  Wrench<V> F = timesMotion<Massive>(I, m, r.dw, r.dv);
  if (prismatic) {  // nothing turns: no Coriolis' force but by what turns before
    addTo(F.n, {-f.y, f.x, V{}});
    return F;
  }
  // Coriolis' force 2 w x p and moment 2 (trace(Q) w - Q w), of w = (w.x, w.y, 0)
  const Vec<V>& w = r.w;
  addTo(F.f, {w.y * flow.p.z - f.y, f.x - w.x * flow.p.z, w.x * flow.p.y - w.y * flow.p.x});
  addTo(F.n,
        {(flow.y.y + flow.z.z) * w.x - flow.y.x * w.y - n.y,
         (flow.x.x + flow.z.z) * w.y - flow.x.y * w.x + n.x, -(flow.x.z * w.x + flow.y.z * w.y)});
  return F;
}

/// The other forces of joint i; `factor` is that of the flow, too.
template <bool Massive, typename V>
FAST_INLINE ForceRates<V> forceRates(bool prismatic, const Composite<V>& I, double m,
                                     const Flow<V>& flow, double factor, const AxisRates<V>& r) {
  const V zero{};
  ForceRates<V> rates{};
  rates.by_qd = timesAcross<Massive>(I, m, times(factor, r.w), times(factor, r.v));
  if (prismatic) {
    rates.by_qdd = {{zero, zero, m + zero}, {I.mc.y, -I.mc.x, zero}};
    rates.turned = {flow.p.y, -flow.p.x, zero};
    return rates;
  }
  const V xx_yy = flow.x.x + flow.y.y;  // the moment of w = z
  addTo(rates.by_qd.f, {-flow.p.y, flow.p.x, zero});
  addTo(rates.by_qd.n, {-flow.z.x, -flow.z.y, xx_yy});
  rates.by_qdd = {{-I.mc.y, I.mc.x, zero}, {-I.xz, -I.yz, I.xx + I.yy}};
  rates.turned = {-flow.x.z, -flow.y.z, xx_yy};
  return rates;
}

/// Where the entries go: (i, j) at i + j outer_step.
template <typename V>
struct DerivativeEntries {
  static constexpr bool kByTravel = true;
  static constexpr double kFlow = 2;  ///< Coriolis' force is twice w x p

  V *by_q, *by_qd, *by_qdd;
  std::ptrdiff_t outer_step;

  FAST_INLINE void set(int row, int column, const V& q, const V& qd, const V& qdd) const {
    const std::ptrdiff_t at = row + column * outer_step;
    by_q[at] = q;
    by_qd[at] = qd;
    by_qdd[at] = qdd;
  }
};

/// Row i and column i at joint j before it, from the forces of joint i, `axial` along the axis of j:
/// what moves joint j is felt by i as motion, what moves joint i by j as force.
template <typename V, typename Forces, typename Entries>
FAST_INLINE void setEntries(int i, int j, int first, const Forces& F, const AxialRates<V>& axial,
                            const AxisRates<V>& r, const Entries& out) {
  const Wrench<V> W = F.inertial();
  const Vec<V> turned = F.coriolis();
  V by_q{};
  if constexpr (Entries::kByTravel) {
    by_q = (r.w.x * turned.x + r.w.y * turned.y) +
           (r.dw.x * W.n.x + r.dw.y * W.n.y + r.dw.z * W.n.z) +
           (r.dv.x * W.f.x + r.dv.y * W.f.y + r.dv.z * W.f.z);
  }
  const V by_qd = r.w.x * W.n.x + r.w.y * W.n.y + r.v.x * W.f.x + r.v.y * W.f.y;
  out.set(i, j, by_q, axial.turned + Entries::kFlow * by_qd, axial.by_qdd);
  if (j >= first) out.set(j, i, axial.by_q, axial.by_qd, axial.by_qdd);
}

/// Rows first .. joints - 1 with one set of parameters.
template <typename S, typename V, typename First, typename Entries>
FAST_INLINE void derivativesOfMotion(const Robot& robot, const State<V>& state,
                                     const MovingLink<V>* links, const Body* bodies, First first,
                                     const Entries& out) {
  Composite<V> I;
  Flow<V> flow;
  Wrench<V> W{};
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const Body& body = bodies[i];
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    const double m = S::kMixed ? body.mass_beyond : 0.0;  // joints that turn leave none
    flow.add(prismatic, body, times(Entries::kFlow, links[i].w), times(Entries::kFlow, links[i].v));
    if (!Entries::kByTravel && i == 0) {  // nothing is before it
      out.set(0, 0, V{}, prismatic ? V{} : flow.x.x + flow.y.y, V{});
      return;
    }
    I.add(body);

    ForceRates<V> rates =
        forceRates<S::kMixed>(prismatic, I, m, flow, Entries::kFlow, links[i].rates);
    if constexpr (Entries::kByTravel) {
      const Wrench<V> own = wrenchOfLink<S>(robot, i, links[i].U, body);
      addTo(W.f, own.f);
      addTo(W.n, own.n);
      rates.by_q = forceByTravel<S::kMixed>(prismatic, I, m, flow, W, links[i].rates);
    }
    typename CarriedOf<V, Entries::kByTravel>::Type F(rates);
    const AxialRates<V> own_axis = along(prismatic, F);
    out.set(i, i, own_axis.by_q, own_axis.by_qd, own_axis.by_qdd + X.rotor_inertia);
    S::backwardsFrom(i, [&](auto j) FAST_LAMBDA {
      F.template carryAll<S>(j, robot, state);
      const bool sliding = S::kMixed && robot.placements[j - 1].prismatic;
      setEntries(i, j - 1, first, F, along(sliding, F), links[j - 1].rates, out);
    });
    if (i == first) return;

    // on to the parent link
    carry<S>(i, robot, state, m, I);
    carry<S>(i, robot, state, W);
    flow.template carry<S>(i, robot, state);
  });
}

/// Derivatives by q, qd, qdd.
template <typename S, typename V>
void torqueDerivatives(const Robot& robot, const State<V>& state, const double* root,
                       const DerivativeEntries<V>& to) {
  // packs stand side by side; that makes their places constants
  DerivativeEntries<V> out = to;
  if (sizeof(V) != sizeof(double)) out.outer_step = S::count(robot);
  MovingLink<V> links[S::kJoints];
  moveLinks<S>(robot, state, root, links);
  // each set overwrites all rows but those before its own
  const int sets = robot.rows != nullptr ? robot.joints : 1;
  for (int set = 0; set < sets; ++set) {
    const Body* bodies = robot.rows != nullptr ? robot.rows[set] : robot.bodies;
    derivativesOfMotion<S>(robot, state, links, bodies, set, out);
  }
}

/// each(i, j, dg_i/dq_j = dg_j/dq_i) for j <= i with one set of parameters: second derivatives of
/// potential energy.
template <typename S, typename V, typename Each>
FAST_INLINE void forEachGravityDerivative(const Robot& robot, const State<V>& state,
                                          const Body* bodies, const Each& each) {
  Vec<V> a[S::kJoints];
  gravityInLinks<S>(robot, state, a);
  Vec<V> mc{};
  for (int i = robot.joints - 1; i >= 0; --i) {
    const Body& body = bodies[i];
    const bool prismatic = robot.placements[i].prismatic;
    addTo(mc, {body.mcx + V{}, body.mcy + V{}, body.mcz + V{}});

    // mass that joint i moves, times how it moves
    Vec<V> f{-mc.y, mc.x, V{}};
    if (prismatic) f = {V{}, V{}, body.mass_beyond + V{}};
    for (int j = i; j >= 0; --j) {
      const Placement& Y = robot.placements[j];
      if (!Y.prismatic) each(i, j, f.x * a[j].y - f.y * a[j].x);
      f = outOf<Twist::kAny>(Turn<V>{state.c[j], state.s[j], Y}, f);
    }
    carryPoint<S>(i, robot, state, body.mass_beyond, mc);
  }
}

/// dtau_dq += dg/dq with the set of gravity's own.
template <typename S, typename V>
void addGravityDerivatives(const Robot& robot, const State<V>& state, V* dtau_dq,
                           std::ptrdiff_t outer_step) {
  forEachGravityDerivative<S>(robot, state, robot.gravity_bodies,
                              [&](int i, int j, const V& change) FAST_LAMBDA {
                                dtau_dq[i + j * outer_step] += change;
                                if (j < i) dtau_dq[j + i * outer_step] += change;
                              });
}

/// Row i of dtau_dq += by_load[i] dg_i/dq.
template <typename S, typename V>
void addLoadDerivatives(const Robot& robot, const State<V>& state, const V* by_load, V* dtau_dq,
                        std::ptrdiff_t outer_step) {
  constexpr int kAllRows = -1;
  const auto add = [&](const Body* bodies, int row) {
    forEachGravityDerivative<S>(robot, state, bodies,
                                [&](int i, int j, const V& change) FAST_LAMBDA {
                                  if (row == kAllRows || row == i)
                                    dtau_dq[i + j * outer_step] += by_load[i] * change;
                                  if (j == i || (row != kAllRows && row != j)) return;
                                  dtau_dq[j + i * outer_step] += by_load[j] * change;
                                });
  };
  if (robot.gravity_bodies != nullptr || robot.rows == nullptr) {
    return add(robot.gravity_bodies != nullptr ? robot.gravity_bodies : robot.bodies, kAllRows);
  }
  for (int row = 0; row < robot.joints; ++row) add(robot.rows[row], row);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
