// SPDX-License-Identifier: Apache-2.0

/// @file
/// The tip's pose, Jacobian and its derivative on one structure, in the axes of the root frame.
///
/// Included by the kernels' two sources only [pack.hpp]. As chain_dynamics/tip_kinematics.hpp, in the
/// frames of robot.hpp: those are moved along the joints' axes, which changes no column.

#pragma once

#include <cstddef>

#include "link_motion.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// A link's frame in the axes of the root frame, its origin from that of the first joint's.
template <typename V>
struct Frame {
  Vec<V> x, y, z, p;
};

template <typename V>
FAST_INLINE Vec<V> vecOf(const double* v) {
  return {v[0] + V{}, v[1] + V{}, v[2] + V{}};
}

/// v + a factor
template <typename V, typename Factor>
FAST_INLINE Vec<V> plus(const Vec<V>& v, const Vec<V>& a, const Factor& factor) {
  return {v.x + a.x * factor, v.y + a.y * factor, v.z + a.z * factor};
}

template <typename V>
FAST_INLINE Vec<V> minus(const Vec<V>& a, const Vec<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <typename V>
FAST_INLINE Vec<V> crossed(const Vec<V>& a, const Vec<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// R v, R column by column.
template <typename V>
FAST_INLINE Vec<V> columnOf(const Frame<V>& X, const double* v) {
  const Vec<V> along_x{X.x.x * v[0], X.x.y * v[0], X.x.z * v[0]};
  return plus(plus(along_x, X.y, v[1]), X.z, v[2]);
}

/// Turns a frame about its x axis.
template <Twist Kind, typename V>
FAST_INLINE void twistFrame(const Placement& placement, Frame<V>& X) {
  const Vec<V> y = X.y;
  const Vec<V> z = X.z;
  const double c = placement.cos_twist;
  const double s = placement.sin_twist;
  if constexpr (Kind == Twist::kRight) {
    X.y = z;
    X.z = {-y.x, -y.y, -y.z};
  } else if constexpr (Kind == Twist::kAlmostRight) {
    X.y = plus(z, y, c);
    X.z = {c * z.x - y.x, c * z.y - y.y, c * z.z - y.z};
  } else if constexpr (Kind == Twist::kAny) {
    X.y = {c * y.x + s * z.x, c * y.y + s * z.y, c * y.z + s * z.z};
    X.z = {c * z.x - s * y.x, c * z.y - s * y.y, c * z.z - s * y.z};
  }
}

/// The links' frames from root to tip; each(i, frame).
template <typename S, typename V, typename Each>
FAST_INLINE Frame<V> forEachFrame(const Robot& robot, const State<V>& state, const Each& each) {
  const double* const R = robot.base.R;
  Frame<V> X{vecOf<V>(R), vecOf<V>(R + 3), vecOf<V>(R + 6), {}};
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    const Placement& placement = robot.placements[i];
    if (i != 0) {
      if (S::px(i)) X.p = plus(X.p, X.x, placement.px);
      if (S::py(i)) X.p = plus(X.p, X.y, placement.py);
      constexpr Twist kTwist = S::twist(decltype(i)());
      twistFrame<kTwist>(placement, X);
    }
    const V& c = state.c[i];
    const V& s = state.s[i];
    const Vec<V> x = X.x;
    X.x = {c * x.x + s * X.y.x, c * x.y + s * X.y.y, c * x.z + s * X.y.z};
    X.y = {c * X.y.x - s * x.x, c * X.y.y - s * x.y, c * X.y.z - s * x.z};
    if (S::kMixed && placement.prismatic) X.p = plus(X.p, X.z, state.q[i]);
    each(i, X);
  });
  return X;
}

/// The tip's origin from that of the first joint's frame.
template <typename V>
FAST_INLINE Vec<V> originOfTip(const Robot& robot, const Frame<V>& last) {
  const Vec<V> arm = columnOf(last, robot.tip.p);
  return {last.p.x + arm.x, last.p.y + arm.y, last.p.z + arm.z};
}

/// R, column by column, and p in the root frame.
template <typename S, typename V>
void tipPose(const Robot& robot, const State<V>& state, V* R, V* p) {
  const Frame<V> last = forEachFrame<S>(robot, state, [](auto, const Frame<V>&) FAST_LAMBDA {});
  const Vec<V> tip = originOfTip(robot, last);
  countUp<0, 3>([&](auto k) FAST_LAMBDA {
    const Vec<V> column = columnOf(last, robot.tip.R + 3 * k);
    R[3 * k] = column.x;
    R[3 * k + 1] = column.y;
    R[3 * k + 2] = column.z;
  });
  p[0] = robot.base.p[0] + tip.x;
  p[1] = robot.base.p[1] + tip.y;
  p[2] = robot.base.p[2] + tip.z;
}

/// Where the columns go: (i, j) at i + j outer_step.
template <typename V>
struct JacobianEntries {
  V* data;
  std::ptrdiff_t outer_step;

  FAST_INLINE void set(int column, const Vec<V>& linear, const Vec<V>& angular) const {
    V* const to = data + column * outer_step;
    to[0] = linear.x;
    to[1] = linear.y;
    to[2] = linear.z;
    to[3] = angular.x;
    to[4] = angular.y;
    to[5] = angular.z;
  }
};

/// Packs stand side by side; that makes their places constants.
template <typename V>
FAST_INLINE JacobianEntries<V> sideBySide(const JacobianEntries<V>& to) {
  return {to.data, sizeof(V) == sizeof(double) ? to.outer_step : 6};
}

template <typename S, typename V>
void tipJacobian(const Robot& robot, const State<V>& state, const JacobianEntries<V>& J) {
  const JacobianEntries<V> out = sideBySide(J);
  Vec<V> z[S::kJoints];
  Vec<V> p[S::kJoints];
  const Frame<V> last = forEachFrame<S>(robot, state, [&](auto i, const Frame<V>& X) FAST_LAMBDA {
    z[i] = X.z;
    p[i] = X.p;
  });
  const Vec<V> tip = originOfTip(robot, last);
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    if (S::kMixed && robot.placements[i].prismatic) {
      out.set(i, z[i], Vec<V>{});
    } else {
      out.set(i, crossed(z[i], minus(tip, p[i])), z[i]);
    }
  });
}

template <typename S, typename V>
void tipJacobianDerivative(const Robot& robot, const State<V>& state,
                           const JacobianEntries<V>& dJ) {
  const JacobianEntries<V> out = sideBySide(dJ);
  Vec<V> z[S::kJoints];
  Vec<V> dz[S::kJoints];
  Vec<V> p[S::kJoints];
  Vec<V> dp[S::kJoints];
  Vec<V> w{};
  Vec<V> v{};  // of the link's origin
  Vec<V> before{};
  const Frame<V> last = forEachFrame<S>(robot, state, [&](auto i, const Frame<V>& X) FAST_LAMBDA {
    if (i != 0) addTo(v, crossed(w, minus(X.p, before)));
    before = X.p;
    const bool prismatic = S::kMixed && robot.placements[i].prismatic;
    (prismatic ? v : w) = plus(prismatic ? v : w, X.z, state.qd[i]);
    z[i] = X.z;
    dz[i] = crossed(w, X.z);
    p[i] = X.p;
    dp[i] = v;
  });
  const Vec<V> tip = originOfTip(robot, last);
  addTo(v, crossed(w, minus(tip, before)));
  S::forwards(robot, [&](auto i) FAST_LAMBDA {
    if (S::kMixed && robot.placements[i].prismatic) {
      out.set(i, dz[i], Vec<V>{});
    } else {
      Vec<V> linear = crossed(dz[i], minus(tip, p[i]));
      addTo(linear, crossed(z[i], minus(v, dp[i])));
      out.set(i, linear, dz[i]);
    }
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
