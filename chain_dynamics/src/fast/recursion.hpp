// SPDX-License-Identifier: Apache-2.0

/// @file
/// The recursions on one robot's structure: torques, gravity torques, inertia matrix.
///
/// Included by kernels.cpp only [pack.hpp]. The algorithms are those of torques.hpp,
/// gravity_vector.hpp and inertia_matrix.hpp of this package, written out in components for the
/// frames and parameters of robot.hpp. V is the type of everything that depends on the state: a
/// number, or a pack with a state in each lane. P is the type of inertial parameters: numbers, or a
/// pack with a row's own parameters in each lane.

#pragma once

#include "structure.hpp"

namespace chain_dynamics::fast {
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
template <Twist kTwist, typename V>
FAST_INLINE Vec<V> into(const Turn<V>& t, const Vec<V>& v) {
  V y = v.y;
  V z = v.z;
  if constexpr (kTwist == Twist::kRight) {
    y = v.z;
    z = -v.y;
  } else if constexpr (kTwist == Twist::kAlmostRight) {
    y = t.X.cos_twist * v.y + v.z;
    z = t.X.cos_twist * v.z - v.y;
  } else if constexpr (kTwist == Twist::kAny) {
    y = t.X.cos_twist * v.y + t.X.sin_twist * v.z;
    z = t.X.cos_twist * v.z - t.X.sin_twist * v.y;
  }
  return {t.c * v.x + t.s * y, t.c * y - t.s * v.x, z};
}

/// RotX(twist) v.
template <Twist kTwist, typename P>
FAST_INLINE Vec<P> twisted(const Placement& X, const Vec<P>& v) {
  if constexpr (kTwist == Twist::kRight) {
    return {v.x, -v.z, v.y};
  } else if constexpr (kTwist == Twist::kAlmostRight) {
    return {v.x, X.cos_twist * v.y - v.z, v.y + X.cos_twist * v.z};
  } else if constexpr (kTwist == Twist::kAny) {
    return {v.x, X.cos_twist * v.y - X.sin_twist * v.z, X.sin_twist * v.y + X.cos_twist * v.z};
  } else {
    return v;
  }
}

/// R v: from frame i to frame i - 1.
template <Twist kTwist, typename V, typename P>
FAST_INLINE Vec<P> outOf(const Turn<V>& t, const Vec<P>& v) {
  return twisted<kTwist>(t.X, Vec<P>{t.c * v.x - t.s * v.y, t.s * v.x + t.c * v.y, v.z});
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

template <bool kPrismatic, typename V, typename B>
FAST_INLINE auto wrenchOf(const LinkMotion<V>& U, const B& b) {
  using P = decltype(U.xx * b.mcx);
  const Vec<V>& a = U.a;
  Wrench<P> W;
  if constexpr (kPrismatic) {
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

/// What a state consists of, joint by joint.
template <typename V>
struct State {
  const V* c;
  const V* s;
  const V* q;  // read where joints slide
  const V* qd;
  const V* qdd;
};

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
    each(i, prismatic ? W.f.z : W.n.z);
    if (i == first) return;

    // on to the link before
    if (prismatic) {
      W.n.x -= state.q[i] * W.f.y;
      W.n.y += state.q[i] * W.f.x;
    }
    constexpr Twist kTwist = S::twist(decltype(i)());
    const Turn<V> t{state.c[i], state.s[i], X};
    W.f = outOf<kTwist>(t, W.f);
    W.n = outOf<kTwist>(t, W.n);
    addLever<S>(i, X, W);
  });
}

/// The numbers of a body, for several rows side by side.
template <typename P>
struct BodyLanes {
  P mcx, mcy, Sxx, Sxy, Sxz, Syy, Syz, mcz, m, mass_beyond;

  FAST_INLINE BodyLanes(const Robot& robot, int i, int first_row) {
    const double* const from = robot.row_lanes + i * kBodyNumbers * robot.stride + first_row;
    const auto number = [&](int k) FAST_LAMBDA { return load<P>(from + k * robot.stride); };
    mcx = number(0);
    mcy = number(1);
    Sxx = number(2);
    Sxy = number(3);
    Sxz = number(4);
    Syy = number(5);
    Syz = number(6);
    mcz = number(7);
    m = number(8);
    mass_beyond = number(9);
  }
};

template <typename S, typename V, typename B>
FAST_INLINE auto wrenchOfLink(const Robot& robot, int i, const LinkMotion<V>& U, const B& body) {
  if (S::kMixed && robot.placements[i].prismatic) return wrenchOf<true>(U, body);
  return wrenchOf<false>(U, body);
}

/// tau = H qdd + C qd, and with root the gravity torques; one set of parameters for all rows.
template <typename S, typename V>
void torques(const Robot& robot, const State<V>& state, const double* root, V* tau) {
  Wrench<V> own[S::kJoints];
  forEachMotion<S>(robot, state, root, [&](auto i, const LinkMotion<V>& U) FAST_LAMBDA {
    own[i] = wrenchOfLink<S>(robot, i, U, robot.bodies[i]);
  });
  forEachJointForce<S, V, V>(
      robot, state, Constant<0>(), [&](auto i) FAST_LAMBDA { return own[i]; },
      [&](auto i, const V& force)
          FAST_LAMBDA { tau[i] = force + robot.placements[i].rotor_inertia * state.qdd[i]; });
}

/// The same with a set of parameters for each row.
template <typename S, typename V>
void torquesByRow(const Robot& robot, const State<V>& state, const double* root, V* tau) {
  LinkMotion<V> motion[S::kJoints];
  forEachMotion<S>(robot, state, root,
                   [&](auto i, const LinkMotion<V>& U) FAST_LAMBDA { motion[i] = U; });
  if constexpr (sizeof(V) == sizeof(double)) {
    // rows as lanes
    S::template inSteps<kShortWidth>(robot, [&](auto first) FAST_LAMBDA {
      forEachJointForce<S, V, Short>(
          robot, state, first,
          [&](auto i) FAST_LAMBDA {
            return wrenchOfLink<S>(robot, i, motion[i], BodyLanes<Short>(robot, i, first));
          },
          [&](auto i, const Short& force) FAST_LAMBDA {
            if (i < first + kShortWidth) {
              tau[i] = laneOf(force, i - first) + robot.placements[i].rotor_inertia * state.qdd[i];
            }
          });
    });
  } else {
    // states as lanes, one row after the other
    S::template inSteps<1>(robot, [&](auto row) FAST_LAMBDA {
      forEachJointForce<S, V, V>(
          robot, state, row,
          [&](auto i)
              FAST_LAMBDA { return wrenchOfLink<S>(robot, i, motion[i], robot.rows[row][i]); },
          [&](auto i, const V& force) FAST_LAMBDA {
            if (i == row) tau[i] = force + robot.placements[i].rotor_inertia * state.qdd[i];
          });
    });
  }
}

/// Gravity in the links' frames, then what hangs on each joint as a heavy point, from tip to
/// `first`; each(i, torque).
template <typename S, typename V, typename P, typename First, typename BodyOf, typename Each>
FAST_INLINE void forEachGravity(const Robot& robot, const State<V>& state, First first,
                                const Vec<V>* a, const BodyOf& bodyOf, const Each& each) {
  Vec<P> mc{};
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const auto& body = bodyOf(i);
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    mc.x += body.mcx;
    mc.y += body.mcy;
    if (S::kMixed) mc.z += body.mcz;
    if (prismatic) {
      each(i, body.mass_beyond * a[i].z);
    } else {
      each(i, mc.x * a[i].y - mc.y * a[i].x);
    }
    if (i == first) return;

    // on to the link before
    if (prismatic) mc.z += body.mass_beyond * state.q[i];
    constexpr Twist kTwist = S::twist(decltype(i)());
    mc = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], X}, mc);
    if (S::kMixed) {  // joints that turn leave no mass
      mc.x += body.mass_beyond * X.px;
      mc.y += body.mass_beyond * X.py;
    }
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

/// Gravity torques; one set of parameters for all rows.
template <typename S, typename V>
void gravity(const Robot& robot, const State<V>& state, V* g) {
  const Body* bodies = robot.gravity_bodies != nullptr ? robot.gravity_bodies : robot.bodies;
  Vec<V> a[S::kJoints];
  gravityInLinks<S>(robot, state, a);
  forEachGravity<S, V, V>(
      robot, state, Constant<0>(), a, [&](auto i) FAST_LAMBDA -> const Body& { return bodies[i]; },
      [&](auto i, const V& torque) FAST_LAMBDA { g[i] = torque; });
}

/// The same with a set of parameters for each row.
template <typename S, typename V>
void gravityByRow(const Robot& robot, const State<V>& state, V* g) {
  Vec<V> a[S::kJoints];
  gravityInLinks<S>(robot, state, a);
  if constexpr (sizeof(V) == sizeof(double)) {
    S::template inSteps<kShortWidth>(robot, [&](auto first) FAST_LAMBDA {
      forEachGravity<S, V, Short>(
          robot, state, first, a,
          [&](auto i) FAST_LAMBDA { return BodyLanes<Short>(robot, i, first); },
          [&](auto i, const Short& torque) FAST_LAMBDA {
            if (i < first + kShortWidth) g[i] = laneOf(torque, i - first);
          });
    });
  } else {
    S::template inSteps<1>(robot, [&](auto row) FAST_LAMBDA {
      forEachGravity<S, V, V>(
          robot, state, row, a,
          [&](auto i) FAST_LAMBDA -> const Body& { return robot.rows[row][i]; },
          [&](auto i, const V& torque) FAST_LAMBDA {
            if (i == row) g[i] = torque;
          });
    });
  }
}

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
template <Twist kTwist, typename P>
FAST_INLINE void twist(const Placement& X, Composite<P>& I) {
  const Composite<P> J = I;
  if constexpr (kTwist == Twist::kRight) {
    I.xy = -J.xz;
    I.xz = J.xy;
    I.yy = J.zz;
    I.yz = -J.yz;
    I.zz = J.yy;
  } else if constexpr (kTwist != Twist::kNone) {
    const double c = X.cos_twist;
    const double s = kTwist == Twist::kAlmostRight ? 1.0 : X.sin_twist;
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

/// The composite bodies from tip to `first`, and the forces at each joint j <= i that accelerate
/// joint i by one; each(i, j, H_ij).
template <typename S, typename V, typename P, typename First, typename BodyOf, typename Each>
FAST_INLINE void forEachInertia(const Robot& robot, const State<V>& state, First first,
                                const BodyOf& bodyOf, const Each& each) {
  Composite<P> I;
  S::backwards(robot, first, [&](auto i) FAST_LAMBDA {
    const auto& body = bodyOf(i);
    const Placement& X = robot.placements[i];
    const bool prismatic = S::kMixed && X.prismatic;
    I.add(body);

    // F = I S
    const P zero{};
    Wrench<P> F{{-I.mc.y, I.mc.x, zero}, {-I.xz, -I.yz, I.xx + I.yy}};
    if (prismatic) F = {{zero, zero, body.mass_beyond + zero}, {I.mc.y, -I.mc.x, zero}};
    each(i, i, (prismatic ? F.f.z : F.n.z) + X.rotor_inertia);

    // H_ji = S_j' F in the frames of the joints before
    S::backwardsFrom(i, [&](auto j) FAST_LAMBDA {
      const Placement& Y = robot.placements[j];
      if (S::kMixed && Y.prismatic) {
        F.n.x -= state.q[j] * F.f.y;
        F.n.y += state.q[j] * F.f.x;
      }
      constexpr Twist kTwist = S::twist(decltype(j)());
      const Turn<V> t{state.c[j], state.s[j], Y};
      F.f = outOf<kTwist>(t, F.f);
      F.n = outOf<kTwist>(t, F.n);
      addLever<S>(j, Y, F);
      each(i, j - 1, S::kMixed && robot.placements[j - 1].prismatic ? F.f.z : F.n.z);
    });
    if (i == first) return;

    // on to the link before
    if (prismatic) {
      // moved along z by q
      const P h = I.mc.z + (0.5 * body.mass_beyond) * state.q[i];
      I.xz += state.q[i] * I.mc.x;
      I.yz += state.q[i] * I.mc.y;
      I.zz += 2.0 * (state.q[i] * h);
      I.mc.z += body.mass_beyond * state.q[i];
    }
    constexpr Twist kTwist = S::twist(decltype(i)());
    turn(state.c[i], state.s[i], I);
    twist<kTwist>(X, I);
    I.mc = outOf<kTwist>(Turn<V>{state.c[i], state.s[i], X}, I.mc);
    shift<S>(i, X, body.mass_beyond, I);
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

/// Inertia matrix; one set of parameters for all rows.
template <typename S, typename V>
void inertia(const Robot& robot, const State<V>& state, const Entries<V>& H) {
  forEachInertia<S, V, V>(
      robot, state, Constant<0>(),
      [&](auto i) FAST_LAMBDA -> const Body& { return robot.bodies[i]; },
      [&](auto i, auto j, const V& value) FAST_LAMBDA {
        H.set(i, j, value);
        if (i != j) H.set(j, i, value);
      });
}

/// The same with a set of parameters for each row.
template <typename S, typename V>
void inertiaByRow(const Robot& robot, const State<V>& state, const Entries<V>& H) {
  if constexpr (sizeof(V) == sizeof(double)) {
    S::template inSteps<kShortWidth>(robot, [&](auto first) FAST_LAMBDA {
      const int end = first + kShortWidth;
      forEachInertia<S, V, Short>(
          robot, state, first,
          [&](auto i) FAST_LAMBDA { return BodyLanes<Short>(robot, i, first); },
          [&](auto i, auto j, const Short& value) FAST_LAMBDA {
            if (i < end) H.set(i, j, laneOf(value, i - first));
            if (first <= j && j < end && i != j) H.set(j, i, laneOf(value, j - first));
          });
    });
  } else {
    S::template inSteps<1>(robot, [&](auto row) FAST_LAMBDA {
      forEachInertia<S, V, V>(
          robot, state, row, [&](auto i) FAST_LAMBDA -> const Body& { return robot.rows[row][i]; },
          [&](auto i, auto j, const V& value) FAST_LAMBDA {
            if (i == row) {
              H.set(row, j, value);
            } else if (j == row) {
              H.set(row, i, value);
            }
          });
    });
  }
}

}  // namespace
}  // namespace chain_dynamics::fast
