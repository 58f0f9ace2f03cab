// SPDX-License-Identifier: Apache-2.0

/// @file
/// How the links move, from root to tip, and what each needs for it.
///
/// Included by the kernels' two sources only [pack.hpp]. The algorithms of this and the next files
/// (torques, gravity, inertia) are those of the headers of the same names in this package, written out in
/// components for the frames and parameters of robot.hpp. V is the type of everything that depends
/// on the state: a number, or a pack with a state in each lane. P is the type of inertial
/// parameters: numbers, or a pack with a row's own parameters in each lane.

#pragma once

#include <cstddef>
#include <utility>

#include "structure.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

template <typename V>
struct Vec {
  V x, y, z;
};

template <typename V>
FAST_INLINE void addTo(Vec<V>& a, const Vec<V>& b) {
  a.x += b.x;
  a.y += b.y;
  a.z += b.z;
}

/// Cosine and sine of one joint's angle, and what it is placed by.
template <typename V>
struct Turn {
  const V& c;
  const V& s;
  const Placement& X;
};

/// R' v: from frame i - 1 to frame i.
template <Twist Kind, typename V>
FAST_INLINE Vec<V> into(const Turn<V>& t, const Vec<V>& v) {
  V y = v.y;
  V z = v.z;
  if constexpr (Kind == Twist::kRight) {
    y = v.z;
    z = -v.y;
  } else if constexpr (Kind == Twist::kAlmostRight) {
    y = t.X.cos_twist * v.y + v.z;
    z = t.X.cos_twist * v.z - v.y;
  } else if constexpr (Kind == Twist::kAny) {
    y = t.X.cos_twist * v.y + t.X.sin_twist * v.z;
    z = t.X.cos_twist * v.z - t.X.sin_twist * v.y;
  }
  return {t.c * v.x + t.s * y, t.c * y - t.s * v.x, z};
}

/// RotX(twist) v.
template <Twist Kind, typename P>
FAST_INLINE Vec<P> twisted(const Placement& X, const Vec<P>& v) {
  if constexpr (Kind == Twist::kRight) {
    return {v.x, -v.z, v.y};
  } else if constexpr (Kind == Twist::kAlmostRight) {
    return {v.x, X.cos_twist * v.y - v.z, v.y + X.cos_twist * v.z};
  } else if constexpr (Kind == Twist::kAny) {
    return {v.x, X.cos_twist * v.y - X.sin_twist * v.z, X.sin_twist * v.y + X.cos_twist * v.z};
  } else {
    return v;
  }
}

/// R v: from frame i to frame i - 1.
template <Twist Kind, typename V, typename P>
FAST_INLINE Vec<P> outOf(const Turn<V>& t, const Vec<P>& v) {
  return twisted<Kind>(t.X, Vec<P>{t.c * v.x - t.s * v.y, t.s * v.x + t.c * v.y, v.z});
}

/// How one link moves: U = [dw]x + [w]x [w]x, so that a point r of it accelerates by a + U r.
template <typename V>
struct LinkMotion {
  V xx, xy, xz, yx, yy, yz, zx, zy, zz;
  V zz_yy, xx_zz, yy_xx;  // differences of the diagonal
  Vec<V> a;
};

template <typename V>
FAST_INLINE LinkMotion<V> motionOf(const Vec<V>& w, const Vec<V>& dw, const Vec<V>& a) {
  const V x2 = w.x * w.x;
  const V y2 = w.y * w.y;
  const V z2 = w.z * w.z;
  LinkMotion<V> U;
  U.xx = -(y2 + z2);
  U.yy = -(x2 + z2);
  U.zz = -(x2 + y2);
  U.xy = w.x * w.y - dw.z;
  U.yx = w.x * w.y + dw.z;
  U.xz = w.x * w.z + dw.y;
  U.zx = w.x * w.z - dw.y;
  U.yz = w.y * w.z - dw.x;
  U.zy = w.y * w.z + dw.x;
  U.zz_yy = z2 - y2;
  U.xx_zz = x2 - z2;
  U.yy_xx = y2 - x2;
  U.a = a;
  return U;
}

/// Force and moment, about the frame's origin, that a link's own mass needs for its motion.
template <typename P>
struct Wrench {
  Vec<P> f, n;
};

/// n += p x f
template <typename S, typename I, typename P>
FAST_INLINE void addLever(I i, const Placement& X, Wrench<P>& W) {
  if (S::px(i)) {
    W.n.y -= X.px * W.f.z;
    W.n.z += X.px * W.f.y;
  }
  if (S::py(i)) {
    W.n.x += X.py * W.f.z;
    W.n.z -= X.py * W.f.x;
  }
}

/// What a state consists of, joint by joint.
template <typename V>
struct State {
  const V* c;
  const V* s;
  const V* q;  // read where joints slide
  const V* qd;
  const V* qdd;
};

/// On to the parent link of joint i.
template <typename S, typename I, typename V, typename P>
FAST_INLINE void carry(I i, const Robot& robot, const State<V>& state, Wrench<P>& W) {
  const Placement& X = robot.placements[i];
  if (S::kMixed && X.prismatic) {
    W.n.x -= state.q[i] * W.f.y;
    W.n.y += state.q[i] * W.f.x;
  }
  constexpr Twist kTwist = S::twist(I());
  const Turn<V> t{state.c[i], state.s[i], X};
  W.f = outOf<kTwist>(t, W.f);
  W.n = outOf<kTwist>(t, W.n);
  addLever<S>(i, X, W);
}

template <bool Prismatic, typename V, typename B>
FAST_INLINE auto wrenchOf(const LinkMotion<V>& U, const B& b) {
  using P = decltype(U.xx * b.mcx);
  const Vec<V>& a = U.a;
  Wrench<P> W;
  if constexpr (Prismatic) {
    W.f = {b.m * a.x + U.xx * b.mcx + U.xy * b.mcy + U.xz * b.mcz,
           b.m * a.y + U.yx * b.mcx + U.yy * b.mcy + U.yz * b.mcz,
           b.m * a.z + U.zx * b.mcx + U.zy * b.mcy + U.zz * b.mcz};
    W.n = {b.mcy * a.z - b.mcz * a.y, b.mcz * a.x - b.mcx * a.z, b.mcx * a.y - b.mcy * a.x};
  } else {
    W.f = {U.xx * b.mcx + U.xy * b.mcy, U.yx * b.mcx + U.yy * b.mcy, U.zx * b.mcx + U.zy * b.mcy};
    W.n = {(U.zx * b.Sxy + U.zy * b.Syy) + (U.zz_yy * b.Syz - U.yx * b.Sxz) + b.mcy * a.z,
           (U.xx_zz * b.Sxz + U.xy * b.Syz) - (U.zx * b.Sxx + U.zy * b.Sxy) - b.mcx * a.z,
           (U.yx * b.Sxx + U.yy_xx * b.Sxy) + (U.yz * b.Sxz - U.xy * b.Syy) - U.xz * b.Syz +
               (b.mcx * a.y - b.mcy * a.x)};
  }
  return W;
}

/// The links' motion from root to tip; each(i, motion).
template <typename S, typename V, typename Each>
FAST_INLINE void forEachMotion(const Robot& robot, const State<V>& state, const double* root,
                               const Each& each) {
  const V zero{};
  Vec<V> w{zero, zero, zero};
  Vec<V> dw = w;
  Vec<V> a{root[0] + zero, root[1] + zero, root[2] + zero};
  LinkMotion<V> U{};
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    const Placement& X = robot.placements[i];
    const Turn<V> t{state.c[i], state.s[i], X};
    if (i == 0) {
      a = into<Twist::kNone>(t, a);
      if (S::kMixed && X.prismatic) {
        a.z += state.qdd[i];
      } else {
        w.z = state.qd[i];
        dw.z = state.qdd[i];
      }
    } else {
      // a of the new origin, then everything in the new frame
      if (S::px(i)) addTo(a, {U.xx * X.px, U.yx * X.px, U.zx * X.px});
      if (S::py(i)) addTo(a, {U.xy * X.py, U.yy * X.py, U.zy * X.py});
      constexpr Twist kTwist = S::twist(decltype(i)());
      w = into<kTwist>(t, w);
      dw = into<kTwist>(t, dw);
      a = into<kTwist>(t, a);
      const V& qd = state.qd[i];
      if (S::kMixed && X.prismatic) {
        const LinkMotion<V> slid = motionOf(w, dw, a);
        const V& q = state.q[i];
        addTo(a, {slid.xz * q + 2.0 * (w.y * qd), slid.yz * q - 2.0 * (w.x * qd),
                  slid.zz * q + state.qdd[i]});
      } else {
        dw = {dw.x + w.y * qd, dw.y - w.x * qd, dw.z + state.qdd[i]};
        w.z += qd;
      }
    }
    U = motionOf(w, dw, a);
    each(i, U);
  });
}

/// A struct of numbers from number(0), number(1), ...
template <typename Numbers, typename Number, std::size_t... K>
FAST_INLINE Numbers numbersBy(const Number& number, std::index_sequence<K...>) {
  return {number(K)...};
}

/// Rows with parameters of their own that are computed side by side from one motion: of a pack of
/// states one row at a time, ...
template <typename V>
struct Rows {
  using P = V;
  static constexpr int kCount = 1;
  static FAST_INLINE const Body& body(const Robot& robot, int i, int row) {
    return robot.rows[row][i];
  }
  static FAST_INLINE const V& number(const V& value, int) { return value; }
};

/// ... and of one state, one row per lane.
template <>
struct Rows<double> {
  using P = Short;
  static constexpr int kCount = kShortWidth;
  static FAST_INLINE BodyOf<P> body(const Robot& robot, int i, int first_row) {
    const double* const from =
        robot.row_lanes + std::ptrdiff_t{i} * kBodyNumbers * robot.stride + first_row;
    const auto number = [&](std::size_t k) FAST_LAMBDA {
      return load<P>(from + static_cast<std::ptrdiff_t>(k) * robot.stride);
    };
    return numbersBy<BodyOf<P>>(number, std::make_index_sequence<kBodyNumbers>());
  }
  static FAST_INLINE double number(const P& value, int row) { return laneOf(value, row); }
};

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
