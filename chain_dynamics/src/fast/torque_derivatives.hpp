// SPDX-License-Identifier: Apache-2.0

/// @file
/// Derivatives of the torques on one structure, H among them: blocks of links from tip to root.
///
/// Included by kernels.cpp only [pack.hpp]. The four forces that go from each joint to those before
/// it stand side by side in one pack [ForceRates in chain_dynamics/torque_derivatives.hpp].

#pragma once

#include "gravity_vector.hpp"
#include "inertia_matrix.hpp"
#include "torques.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// by_q, by_qd, by_qdd, turned; not in a register of its own where the widest holds two.
using Four __attribute__((vector_size(4 * sizeof(double)))) = double;

/// What a unit of a joint's travel adds to the motion of all links after it.
struct AxisRates {
  Vec<double> w, v;    ///< V x S
  Vec<double> dw, dv;  ///< A x S + V x (V x S)
};

/// A link's motion, with what torques alone don't need.
struct MovingLink {
  LinkMotion<double> U;
  Vec<double> w, v;
  AxisRates rates;
};

FAST_INLINE AxisRates ratesOf(bool prismatic, const LinkMotion<double>& U, const Vec<double>& w,
                              const Vec<double>& v) {
  const Vec<double> w_x_z{w.y, -w.x, 0.0};
  const Vec<double> U_z{U.xz, U.yz, U.zz};
  if (prismatic) return {{}, w_x_z, {}, U_z};
  const Vec<double> a_x_z{U.a.y + 2.0 * (v.z * w.x), 2.0 * (v.z * w.y) - U.a.x,
                          -2.0 * (v.x * w.x + v.y * w.y)};
  return {w_x_z, {v.y, -v.x, 0.0}, U_z, a_x_z};
}

FAST_INLINE Vec<double> twice(const Vec<double>& v) { return {2.0 * v.x, 2.0 * v.y, 2.0 * v.z}; }

/// From root to tip.
template <typename S>
FAST_INLINE void moveLinks(const Robot& robot, const State<double>& state, const double* root,
                           MovingLink* links) {
  Vec<double> w{};
  Vec<double> v{};
  forEachMotion<S>(robot, state, root, [&](auto i, const LinkMotion<double>& U) FAST_LAMBDA {
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    if (i != 0) {
      constexpr Twist kTwist = S::twist(decltype(i)());
      const Turn<double> t{state.c[i], state.s[i], X};
      if (S::px(i)) addTo(v, {0.0, w.z * X.px, -w.y * X.px});
      if (S::py(i)) addTo(v, {-w.z * X.py, 0.0, w.x * X.py});
      w = into<kTwist>(t, w);
      v = into<kTwist>(t, v);
    }
    if (prismatic) {
      addTo(v, {w.y * state.q[i], -w.x * state.q[i], state.qd[i]});
    } else {
      w.z += state.qd[i];
    }
    links[i] = {U, w, v, ratesOf(prismatic, U, w, v)};
  });
}

/// How the mass of a link and all after it flows [chain_dynamics/mass_flow.hpp], twice: for points
/// of mass m at r with velocity u.
struct Flow {
  Vec<double> p{};            ///< sum of 2 m u
  Vec<double> x{}, y{}, z{};  ///< columns of the sum of 2 m u r'

  FAST_INLINE void add(bool prismatic, const Body& b, const MovingLink& link) {
    const Vec<double> w = twice(link.w);
    const Vec<double> v = twice(link.v);
    addTo(p, {-(w.z * b.mcy), w.z * b.mcx, w.x * b.mcy - w.y * b.mcx});
    addTo(x, {v.x * b.mcx, v.y * b.mcx, v.z * b.mcx});
    addTo(y, {v.x * b.mcy, v.y * b.mcy, v.z * b.mcy});
    if (prismatic) {
      addTo(p, {b.m * v.x + w.y * b.mcz, b.m * v.y - w.x * b.mcz, b.m * v.z});
      addTo(z, {v.x * b.mcz, v.y * b.mcz, v.z * b.mcz});
    } else {
      addTo(x, {w.y * b.Sxz - w.z * b.Sxy, w.z * b.Sxx - w.x * b.Sxz, w.x * b.Sxy - w.y * b.Sxx});
      addTo(y, {w.y * b.Syz - w.z * b.Syy, w.z * b.Sxy - w.x * b.Syz, w.x * b.Syy - w.y * b.Sxy});
      addTo(z, {-(w.z * b.Syz), w.z * b.Sxz, w.x * b.Syz - w.y * b.Sxz});
    }
  }

  /// On to the link before.
  template <typename S, typename I>
  FAST_INLINE void carry(I i, const Robot& robot, const State<double>& state) {
    constexpr Twist kTwist = S::twist(I());
    const Placement& X = robot.placements[i];
    const Turn<double> t{state.c[i], state.s[i], X};
    if (S::kMixed && X.prismatic) {
      addTo(z, {p.x * state.q[i], p.y * state.q[i], p.z * state.q[i]});
    }
    p = outOf<kTwist>(t, p);
    x = outOf<kTwist>(t, x);
    y = outOf<kTwist>(t, y);
    z = outOf<kTwist>(t, z);
    const Vec<double> row_x = outOf<kTwist>(t, Vec<double>{x.x, y.x, z.x});
    const Vec<double> row_y = outOf<kTwist>(t, Vec<double>{x.y, y.y, z.y});
    const Vec<double> row_z = outOf<kTwist>(t, Vec<double>{x.z, y.z, z.z});
    x = {row_x.x, row_y.x, row_z.x};
    y = {row_x.y, row_y.y, row_z.y};
    z = {row_x.z, row_y.z, row_z.z};
    if (S::px(i)) addTo(x, {p.x * X.px, p.y * X.px, p.z * X.px});
    if (S::py(i)) addTo(y, {p.x * X.py, p.y * X.py, p.z * X.py});
  }
};

/// I_c (w, v), w and v without z: perpendicular to the joint's axis. Mass counts if Massive.
template <bool Massive>
FAST_INLINE Wrench<double> timesAcross(const Composite<double>& I, double m, const Vec<double>& w,
                                       const Vec<double>& v) {
  Wrench<double> F{{w.y * I.mc.z, -(w.x * I.mc.z), w.x * I.mc.y - w.y * I.mc.x},
                   {(I.yy + I.zz) * w.x - I.xy * w.y - I.mc.z * v.y,
                    (I.xx + I.zz) * w.y - I.xy * w.x + I.mc.z * v.x,
                    (I.mc.x * v.y - I.mc.y * v.x) - I.xz * w.x - I.yz * w.y}};
  if constexpr (Massive) addTo(F.f, {m * v.x, m * v.y, 0.0});
  return F;
}

/// I_c (w, v). Mass counts if Massive.
template <bool Massive>
FAST_INLINE Wrench<double> timesMotion(const Composite<double>& I, double m, const Vec<double>& w,
                                       const Vec<double>& v) {
  Wrench<double> F = timesAcross<Massive>(I, m, w, v);
  addTo(F.f, {-(w.z * I.mc.y), w.z * I.mc.x, 0.0});
  if constexpr (Massive) F.f.z += m * v.z;
  addTo(F.n, {I.mc.y * v.z - I.xz * w.z, -(I.mc.x * v.z) - I.yz * w.z, (I.xx + I.yy) * w.z});
  return F;
}

/// The forces of joint i, side by side. `force` is what goes through it, `m` the mass of what it
/// moves, if Massive.
template <bool Massive>
FAST_INLINE Wrench<Four> forceRates(bool prismatic, const Composite<double>& I, double m,
                                    const Flow& flow, const Wrench<double>& force,
                                    const AxisRates& r) {
  const Wrench<double> first = timesAcross<Massive>(I, m, twice(r.w), twice(r.v));
  const Wrench<double> second = timesMotion<Massive>(I, m, r.dw, r.dv);
  const Vec<double>& f = force.f;
  const Vec<double>& n = force.n;
  if (prismatic) {
    // nothing turns: no Coriolis' force but by what turns before
    return {
        {Four{second.f.x, first.f.x, 0, 0}, Four{second.f.y, first.f.y, 0, 0},
         Four{second.f.z, first.f.z, m, 0}},
        {Four{second.n.x - f.y, first.n.x, I.mc.y, flow.p.y},
         Four{second.n.y + f.x, first.n.y, -I.mc.x, -flow.p.x}, Four{second.n.z, first.n.z, 0, 0}}};
  }
  // Coriolis' force 2 w x p and moment 2 (trace(Q) w - Q w), of w = (w.x, w.y, 0) and of z
  const Vec<double>& w = r.w;
  const double xx_yy = flow.x.x + flow.y.y;
  const double c_x = (flow.y.y + flow.z.z) * w.x - flow.y.x * w.y;
  const double c_y = (flow.x.x + flow.z.z) * w.y - flow.x.y * w.x;
  const double c_z = flow.x.z * w.x + flow.y.z * w.y;
  return {{Four{second.f.x - f.y + w.y * flow.p.z, first.f.x - flow.p.y, -I.mc.y, 0},
           Four{second.f.y + f.x - w.x * flow.p.z, first.f.y + flow.p.x, I.mc.x, 0},
           Four{second.f.z + w.x * flow.p.y - w.y * flow.p.x, first.f.z, 0, 0}},
          {Four{second.n.x - n.y + c_x, first.n.x - flow.z.x, -I.xz, -flow.x.z},
           Four{second.n.y + n.x + c_y, first.n.y - flow.z.y, -I.yz, -flow.y.z},
           Four{second.n.z - c_z, first.n.z + xx_yy, I.xx + I.yy, xx_yy}}};
}

/// Where the entries go.
struct DerivativeEntries {
  double *by_q, *by_qd, *by_qdd;
  std::ptrdiff_t outer_step;

  FAST_INLINE void set(int row, int column, double q, double qd, double qdd) const {
    const std::ptrdiff_t at = row + column * outer_step;
    by_q[at] = q;
    by_qd[at] = qd;
    by_qdd[at] = qdd;
  }
};

/// Row i and column i at joint j before it, from the forces of joint i, `along` the axis of j: what
/// moves joint j is felt by i as motion, what moves joint i by j as force.
FAST_INLINE void setEntries(int i, int j, int first, const Wrench<Four>& F, const Four& along,
                            const AxisRates& r, const DerivativeEntries& out) {
  const Vec<Four>& n = F.n;
  const Vec<Four>& f = F.f;
  const double by_q = (r.w.x * n.x[3] + r.w.y * n.y[3]) +
                      (r.dw.x * n.x[2] + r.dw.y * n.y[2] + r.dw.z * n.z[2]) +
                      (r.dv.x * f.x[2] + r.dv.y * f.y[2] + r.dv.z * f.z[2]);
  const double by_qd = r.w.x * n.x[2] + r.w.y * n.y[2] + r.v.x * f.x[2] + r.v.y * f.y[2];
  out.set(i, j, by_q, along[3] + 2.0 * by_qd, along[2]);
  if (j >= first) out.set(j, i, along[0], along[1], along[2]);
}

/// Rows first .. joints - 1 with one set of parameters.
template <typename S>
FAST_INLINE void derivativesOfMotion(const Robot& robot, const State<double>& state,
                                     const MovingLink* links, const Body* bodies, int first,
                                     const DerivativeEntries& out) {
  Composite<double> I;
  Flow flow;
  Wrench<double> W{};
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const Body& body = bodies[i];
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    const double m = S::kMixed ? body.mass_beyond : 0.0;  // joints that turn leave none
    const Wrench<double> own = wrenchOfLink<S>(robot, i, links[i].U, body);
    addTo(W.f, own.f);
    addTo(W.n, own.n);
    I.add(body);
    flow.add(prismatic, body, links[i]);

    Wrench<Four> F = forceRates<S::kMixed>(prismatic, I, m, flow, W, links[i].rates);
    const Four& along = prismatic ? F.f.z : F.n.z;
    out.set(i, i, along[0], along[1], along[2] + X.rotor_inertia);
    S::backwardsFrom(i, [&](auto j) FAST_LAMBDA {
      carry<S>(j, robot, state, F);
      const bool sliding = S::kMixed && robot.placements[j - 1].prismatic;
      setEntries(i, j - 1, first, F, sliding ? F.f.z : F.n.z, links[j - 1].rates, out);
    });
    if (i == first) return;

    // on to the link before
    carry<S>(i, robot, state, m, I);
    carry<S>(i, robot, state, W);
    flow.carry<S>(i, robot, state);
  });
}

/// Derivatives by q, qd, qdd.
template <typename S>
void torqueDerivatives(const Robot& robot, const State<double>& state, const double* root,
                       const DerivativeEntries& out) {
  MovingLink links[S::kJoints];
  moveLinks<S>(robot, state, root, links);
  // each set overwrites all rows but those before its own
  const int sets = robot.rows != nullptr ? robot.joints : 1;
  for (int set = 0; set < sets; ++set) {
    const Body* bodies = robot.rows != nullptr ? robot.rows[set] : robot.bodies;
    derivativesOfMotion<S>(robot, state, links, bodies, set, out);
  }
}

/// dtau_dq += dg/dq with the set of gravity's own: second derivatives of potential energy.
void addGravityDerivatives(const Robot& robot, const State<double>& state, double* dtau_dq,
                           std::ptrdiff_t outer_step) {
  using S = AnyStructure;
  Vec<double> a[kMaxJoints];
  gravityInLinks<S>(robot, state, a);
  Vec<double> mc{};
  for (int i = robot.joints - 1; i >= 0; --i) {
    const Body& body = robot.gravity_bodies[i];
    const bool prismatic = robot.placements[i].prismatic;
    addTo(mc, {body.mcx, body.mcy, body.mcz});

    // mass that joint i moves, times how it moves
    Vec<double> f{-mc.y, mc.x, 0.0};
    if (prismatic) f = {0.0, 0.0, body.mass_beyond};
    for (int j = i; j >= 0; --j) {
      const Placement& Y = robot.placements[j];
      if (!Y.prismatic) {
        const double change = f.x * a[j].y - f.y * a[j].x;
        dtau_dq[i + j * outer_step] += change;
        if (j < i) dtau_dq[j + i * outer_step] += change;
      }
      f = outOf<Twist::kAny>(Turn<double>{state.c[j], state.s[j], Y}, f);
    }
    carryPoint<S>(i, robot, state, body.mass_beyond, mc);
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
