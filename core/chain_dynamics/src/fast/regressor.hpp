// SPDX-License-Identifier: Apache-2.0

/// @file
/// Regressor of the torques. Lanes are the rows of all joints of one state, or many states.
///
/// Included by the kernels' two sources only [pack.hpp]. All ten parameters of a link, in the frame
/// that its description has: neither the few parameters nor the simple frames of the other kernels
/// are of use. The axes of the joints go along from link to link, as motions, and meet what each link
/// would need for one unit of each of its parameters [chain_dynamics/regressor.hpp].

#pragma once

#include <cstddef>

#include "link_motion.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Axes and origin of a link's frame in that of the parent link; z depends on no position.
template <typename V>
struct Pose {
  Vec<V> x, y;
  Vec<double> z;
  Vec<V> p;
};

template <typename V>
FAST_INLINE Pose<V> poseOf(const OwnPlacement& own, const V& c, const V& s, const V& q) {
  const double* const R = own.R;  // columns
  const V zero{};
  Pose<V> X{{R[0] * c + R[3] * s, R[1] * c + R[4] * s, R[2] * c + R[5] * s},
            {R[3] * c - R[0] * s, R[4] * c - R[1] * s, R[5] * c - R[2] * s},
            {R[6], R[7], R[8]},
            {own.p[0] + zero, own.p[1] + zero, own.p[2] + zero}};
  if (own.prismatic) addTo(X.p, {X.z.x * q, X.z.y * q, X.z.z * q});
  return X;
}

template <typename V, typename P>
FAST_INLINE P dot(const Vec<V>& a, const Vec<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// R' v
template <typename V, typename P>
FAST_INLINE Vec<P> into(const Pose<V>& X, const Vec<P>& v) {
  return {dot(X.x, v), dot(X.y, v), dot(X.z, v)};
}

/// v + w x p
template <typename V, typename P>
FAST_INLINE Vec<P> leverOf(const Vec<P>& v, const Vec<P>& w, const Vec<V>& p) {
  return {v.x + (w.y * p.z - w.z * p.y), v.y + (w.z * p.x - w.x * p.z),
          v.z + (w.x * p.y - w.y * p.x)};
}

/// From link to link, as in forEachMotion() but between any frames.
template <typename V>
struct OwnMotion {
  Vec<V> w{}, dw{}, a;
  LinkMotion<V> U{};
  V yz{}, zx{}, xy{};  // products of w

  FAST_INLINE explicit OwnMotion(const Robot& robot)
      : a{robot.root[0] + V{}, robot.root[1] + V{}, robot.root[2] + V{}} {}

  FAST_INLINE void step(const Pose<V>& X, bool prismatic, const V& qd, const V& qdd) {
    addTo(a,
          {U.xx * X.p.x + U.xy * X.p.y + U.xz * X.p.z, U.yx * X.p.x + U.yy * X.p.y + U.yz * X.p.z,
           U.zx * X.p.x + U.zy * X.p.y + U.zz * X.p.z});
    w = into(X, w);
    dw = into(X, dw);
    a = into(X, a);
    if (prismatic) {
      addTo(a, {2.0 * (w.y * qd), -2.0 * (w.x * qd), qdd});
    } else {
      dw = {dw.x + w.y * qd, dw.y - w.x * qd, dw.z + qdd};
      w.z += qd;
    }
    U = motionOf(w, dw, a);
    yz = w.y * w.z;
    zx = w.z * w.x;
    xy = w.x * w.y;
  }
};

/// A link's column of the rows whose joints' axes, seen from the link, are (w, v): power of the force
/// that a unit of the parameter needs.
template <int Column, typename V, typename P>
FAST_INLINE P regressorColumn(const OwnMotion<V>& motion, const Vec<P>& w, const Vec<P>& v) {
  const LinkMotion<V>& U = motion.U;
  const Vec<V>& a = motion.a;
  const Vec<V>& dw = motion.dw;
  // m: (0, a)
  if constexpr (Column == 0) return dot(a, v);
  // mc: (mc x a, U mc)
  if constexpr (Column == 1) return dot(Vec<V>{U.xx, U.yx, U.zx}, v) + (a.y * w.z - a.z * w.y);
  if constexpr (Column == 2) return dot(Vec<V>{U.xy, U.yy, U.zy}, v) + (a.z * w.x - a.x * w.z);
  if constexpr (Column == 3) return dot(Vec<V>{U.xz, U.yz, U.zz}, v) + (a.x * w.y - a.y * w.x);
  // I: (I dw + w x I w, 0)
  if constexpr (Column == 4) return dw.x * w.x + motion.zx * w.y - motion.xy * w.z;
  if constexpr (Column == 5) return U.zy * w.y - U.zx * w.x - U.yy_xx * w.z;
  if constexpr (Column == 6) return U.yx * w.x - U.xx_zz * w.y - U.yz * w.z;
  if constexpr (Column == 7) return dw.y * w.y + motion.xy * w.z - motion.yz * w.x;
  if constexpr (Column == 8) return U.xz * w.z - U.zz_yy * w.x - U.xy * w.y;
  if constexpr (Column == 9) return dw.z * w.z + motion.yz * w.x - motion.zx * w.y;
}

template <typename V, typename P>
FAST_INLINE void regressorColumns(const OwnMotion<V>& motion, const Vec<P>& w, const Vec<P>& v,
                                  P* columns) {
  countUp<0, 10>([&](auto column)
                     FAST_LAMBDA { columns[column] = regressorColumn<column>(motion, w, v); });
}

/// The axis of the joint of this lane, in the frame of its own link; lanes after it are zero.
FAST_INLINE void startAxis(bool prismatic, int lane, Vec<Short>& w, Vec<Short>& v) {
  constexpr int kMost = 4;
  static constexpr double kOne[2 * kMost] = {0, 0, 0, 0, 1};
  static constexpr double kBefore[2 * kMost] = {1, 1, 1, 1};
  const ShortBits before = load<Short>(kBefore + kMost - lane) != 0.0;
  const Short zero{};
  w = {before ? w.x : zero, before ? w.y : zero, before ? w.z : zero};
  v = {before ? v.x : zero, before ? v.y : zero, before ? v.z : zero};
  (prismatic ? v : w).z += load<Short>(kOne + kMost - lane);
}

/// The first `Rows` lanes of ten columns.
template <int Rows>
FAST_INLINE void storeRows(const Short* columns, double* to, std::ptrdiff_t outer_step) {
  for (int column = 0; column < 10; ++column) {
    double* const rows = to + column * outer_step;
    if constexpr (Rows == kShortWidth) {
      store(columns[column], rows);
    } else {
      for (int lane = 0; lane < Rows; ++lane) rows[lane] = columns[column][lane];
    }
  }
}

FAST_INLINE void storeRows(const Short* columns, int rows, double* to, std::ptrdiff_t outer_step) {
  if (rows >= kShortWidth) return storeRows<kShortWidth>(columns, to, outer_step);
  if (rows == 1) return storeRows<1>(columns, to, outer_step);
  if constexpr (kShortWidth == 4) {
    if (rows == 2) return storeRows<2>(columns, to, outer_step);
    storeRows<3>(columns, to, outer_step);
  }
}

/// Y(i, j) at Y[i + j * outer_step].
inline void regressor(const Robot& robot, const State<double>& state, double* Y,
                      std::ptrdiff_t outer_step) {
  static constexpr Short kZeros[10] = {};
  const int n = robot.joints;
  Vec<Short> w[kMaxJoints / kShortWidth];  // axes of the joints so far
  Vec<Short> v[kMaxJoints / kShortWidth];
  OwnMotion<double> motion(robot);
  for (int i = 0; i < n; ++i) {
    const OwnPlacement& own = robot.own[i];
    const Pose<double> X = poseOf(own, state.c[i], state.s[i], state.q[i]);
    motion.step(X, own.prismatic, state.qd[i], state.qdd[i]);
    double* const link = Y + std::ptrdiff_t{i} * 10 * outer_step;
    for (int first = 0, k = 0; first < n; first += kShortWidth, ++k) {
      if (first > i) {
        storeRows(kZeros, n - first, link + first, outer_step);
        continue;
      }
      if (first == i) {
        w[k] = Vec<Short>{};
        v[k] = Vec<Short>{};
      } else {
        v[k] = into(X, leverOf(v[k], w[k], X.p));
        w[k] = into(X, w[k]);
      }
      if (i < first + kShortWidth) startAxis(own.prismatic, i - first, w[k], v[k]);
      Short columns[10];
      regressorColumns(motion, w[k], v[k], columns);
      storeRows(columns, n - first, link + first, outer_step);
    }
  }
}

/// The links of a pack of states, in each lane its own: each(i, motion, w, v) with the axes of all
/// joints seen from link i; those after joint i are zero. The axis of joint j comes times scale[j].
template <typename V, typename Each>
FAST_INLINE void forEachRegressorLink(const Robot& robot, const State<V>& state, const V* scale,
                                      const Each& each) {
  Vec<V> w[kMaxJoints];
  Vec<V> v[kMaxJoints];
  OwnMotion<V> motion(robot);
  for (int j = 0; j < robot.joints; ++j) w[j] = v[j] = Vec<V>{};
  for (int i = 0; i < robot.joints; ++i) {
    const OwnPlacement& own = robot.own[i];
    const Pose<V> X = poseOf(own, state.c[i], state.s[i], state.q[i]);
    motion.step(X, own.prismatic, state.qd[i], state.qdd[i]);
    for (int j = 0; j < i; ++j) {
      v[j] = into(X, leverOf(v[j], w[j], X.p));
      w[j] = into(X, w[j]);
    }
    (own.prismatic ? v : w)[i].z = scale[i];
    each(i, motion, w, v);
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
