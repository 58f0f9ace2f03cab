// SPDX-License-Identifier: Apache-2.0

/// @file
/// How mass flows past a joint, and what a motion across the joint's axis needs.
///
/// A point of mass m at r that moves with velocity u needs the force 2 m w x u more when its
/// surroundings turn with w: Coriolis' force. Of many bodies that move each in its own way, that is
///
///     force  = sum of 2 m w x u          = 2 w x (sum of m u)
///     moment = sum of r x (2 m w x u)    = 2 (trace(Q) w - Q w),   Q = sum of m u r'
///
/// so twelve numbers say it all, and those of several bodies add up. (As a 6 x 6 matrix on (w, 0)
/// this is 2 B of the literature [Singh, Russell, Wensing 2022, arXiv 2105.05102].)
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "inertia_matrix.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// The forces that a joint's small change needs, of one state: not in a register of its own where the
/// widest holds two.
using Four __attribute__((vector_size(4 * sizeof(double)))) = double;

/// How the mass of a link and all after it flows: for points of mass m at r with velocity u.
template <typename V>
struct Flow {
  Vec<V> p{};            ///< sum of m u
  Vec<V> x{}, y{}, z{};  ///< columns of the sum of m u r'

  /// A link that moves with (w, v).
  FAST_INLINE void add(bool prismatic, const Body& b, const Vec<V>& w, const Vec<V>& v) {
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

  /// On to the parent link.
  template <typename S, typename I>
  FAST_INLINE void carry(I i, const Robot& robot, const State<V>& state) {
    constexpr Twist kTwist = S::twist(I());
    const Placement& X = robot.placements[i];
    const Turn<V> t{state.c[i], state.s[i], X};
    if (S::kMixed && X.prismatic) addTo(z, {p.x * state.q[i], p.y * state.q[i], p.z * state.q[i]});
    p = outOf<kTwist>(t, p);
    x = outOf<kTwist>(t, x);
    y = outOf<kTwist>(t, y);
    z = outOf<kTwist>(t, z);
    const Vec<V> row_x = outOf<kTwist>(t, Vec<V>{x.x, y.x, z.x});
    const Vec<V> row_y = outOf<kTwist>(t, Vec<V>{x.y, y.y, z.y});
    const Vec<V> row_z = outOf<kTwist>(t, Vec<V>{x.z, y.z, z.z});
    x = {row_x.x, row_y.x, row_z.x};
    y = {row_x.y, row_y.y, row_z.y};
    z = {row_x.z, row_y.z, row_z.z};
    if (S::px(i)) addTo(x, {p.x * X.px, p.y * X.px, p.z * X.px});
    if (S::py(i)) addTo(y, {p.x * X.py, p.y * X.py, p.z * X.py});
  }
};

/// I_c (w, v), w and v without z: perpendicular to the joint's axis. Mass counts if Massive.
template <bool Massive, typename V>
FAST_INLINE Wrench<V> timesAcross(const Composite<V>& I, double m, const Vec<V>& w,
                                  const Vec<V>& v) {
  Wrench<V> F{{w.y * I.mc.z, -(w.x * I.mc.z), w.x * I.mc.y - w.y * I.mc.x},
              {(I.yy + I.zz) * w.x - I.xy * w.y - I.mc.z * v.y,
               (I.xx + I.zz) * w.y - I.xy * w.x + I.mc.z * v.x,
               (I.mc.x * v.y - I.mc.y * v.x) - I.xz * w.x - I.yz * w.y}};
  if constexpr (Massive) addTo(F.f, {m * v.x, m * v.y, V{}});
  return F;
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
