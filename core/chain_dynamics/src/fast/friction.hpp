// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction torques of all joints, of one state or of a pack of states.
///
/// The heights of the steps are constants of most robots. Where one changes with load or velocity, or
/// joints share motors, all joints are computed by the functions with `changing` in their names, which
/// aren't inlined.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <cstddef>
#include <utility>

#include "recursions.hpp"
#include "turns.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

template <typename V>
FAST_INLINE V signOf(const V& x) {
  const V zero{};
  const V one = all<V>(1.0);
  return (x > 0.0 ? one : zero) - (x < 0.0 ? one : zero);
}

// Part of the step that is behind at this velocity.
template <typename V>
FAST_INLINE V stepOf(const V& qd, const FrictionNumbers<V>& law) {
  return sigmoid<V>(law.alpha * (qd + law.shift)) - law.center;
}

template <typename V>
FAST_INLINE V frictionOf(const V& qd, const V& height, const FrictionNumbers<V>& law) {
  return law.fv * qd + (law.fc * signOf(qd) + law.fo) + height * stepOf(qd, law);
}

// Its derivative by qd, of a constant height; none at the jump of sign(qd).
template <typename V>
FAST_INLINE V frictionSlopeOf(const V& qd, const V& height, const FrictionNumbers<V>& law) {
  const V x = law.alpha * (qd + law.shift);
  const V e = expOfMinus<V>(x < 0.0 ? -x : x);
  return law.fv + (height * law.alpha) * (e / ((1.0 + e) * (1.0 + e)));
}

// Height of the step under a gravity torque, and its derivative by qd.
template <typename V>
struct ChangingHeight {
  V height, slope;
};

template <typename V>
FAST_INLINE ChangingHeight<V> heightOf(const V& qd, const V& g, const FrictionNumbers<V>& law) {
  // 20: nothing is left of exp(-400)
  const V most = all<V>(20.0);
  V u = qd * law.per_vs;
  u = u > 20.0 ? most : u;
  u = u < -20.0 ? -most : u;
  // 1e-40: powers of the square of a velocity of 1e-100 rad/s would be denormal
  const V stribeck = law.fs * expOfMinus<V>(u * u + 1e-40);
  // (a joint without load friction doesn't see a NaN of the others)
  const V zero{};
  const V load = law.fl > 0.0 ? law.fl * (g < 0.0 ? -g : g) : zero;
  return {law.A + (load + stribeck), -2.0 * law.per_vs * (u * stribeck)};
}

template <typename V, typename Number>
FAST_INLINE FrictionNumbers<V> lawBy(const Number& number) {
  return numbersBy<FrictionNumbers<V>>(number, std::make_index_sequence<kFrictionNumbers>());
}
FAST_INLINE FrictionNumbers<Pack> lawOfPack(const Robot& robot, int joint) {
  return lawBy<Pack>([&](std::size_t k) FAST_LAMBDA {
    return all<Pack>(robot.friction[static_cast<std::ptrdiff_t>(k) * robot.law_stride + joint]);
  });
}

// of(qd, law, joint) for all laws; result has room for a pack at the end.
template <typename Of>
FAST_INLINE void forEachLaw(const Robot& robot, const double* qd, double* result, const Of& of) {
  const int n = robot.laws;
  double padded[kShortWidth] = {};
  for (int i = 0; i < n; i += kShortWidth) {
    const int first = firstOfPack(i, n);
    const double* from = qd + first;
    if (n < kShortWidth) {
      for (int j = 0; j < n; ++j) padded[j] = qd[j];
      from = padded;
    }
    const auto law = lawBy<Short>([&](std::size_t k) FAST_LAMBDA {
      return load<Short>(robot.friction + static_cast<std::ptrdiff_t>(k) * robot.law_stride +
                         first);
    });
    store(of(load<Short>(from), law, first), result + first);
  }
}
template <typename Of>
FAST_INLINE void forEachLaw(const Robot& robot, const Pack* qd, Pack* result, const Of& of) {
  for (int i = 0; i < robot.laws; ++i) result[i] = of(qd[i], lawOfPack(robot, i), i);
}

FAST_INLINE Short atJoint(const double* numbers, int joint) { return load<Short>(numbers + joint); }
FAST_INLINE const Pack& atJoint(const Pack* numbers, int joint) { return numbers[joint]; }

/// Joints, or laws of friction, with room for a pack at the end.
constexpr int kJointSpace = kMaxJoints + kShortWidth;
constexpr int kLawSpace = kMaxLaws + kShortWidth;

/// Gravity torques where friction depends on them; else zeros.
template <typename V>
FAST_INLINE void loadOf(const Robot& robot, int structure, const State<V>& state, V* g) {
  for (int i = 0; i < robot.laws + kShortWidth; ++i) g[i] = V{};
  if (robot.load_friction) recursionsOf<V>(structure).gravity(robot, state, g);
}

/// of(c, law, joint) for each coefficient c of the coupling that isn't zero: a NaN goes no further.
template <typename Of>
FAST_INLINE void forEachCoupling(const Robot& robot, const Of& of) {
  for (int m = 0; m < robot.laws; ++m) {
    for (int i = 0; i < robot.joints; ++i) {
      const double c = robot.coupling[m * robot.joints + i];
      if (c != 0.0) of(c, m, i);
    }
  }
}

/// Velocities at which laws act, in v where they aren't those of the joints.
template <typename V>
FAST_INLINE const V* lawVelocities(const Robot& robot, const V* qd, V* v) {
  if (robot.coupling == nullptr) return qd;
  for (int m = 0; m < robot.laws + kShortWidth; ++m) v[m] = V{};
  forEachCoupling(robot, [&](double c, int m, int i) FAST_LAMBDA { v[m] += c * qd[i]; });
  return v;
}

template <typename V>
FAST_APART void changingFriction(const Robot& robot, int structure, const State<V>& state, V* f) {
  V g[kLawSpace], v[kLawSpace], of_laws[kLawSpace];
  loadOf(robot, structure, state, g);
  V* const to = robot.coupling == nullptr ? f : of_laws;
  forEachLaw(robot, lawVelocities(robot, state.qd, v), to,
             [&](const auto& qd, const auto& law, int joint) FAST_LAMBDA {
               return frictionOf(qd, heightOf(qd, atJoint(g, joint), law).height, law);
             });
  if (robot.coupling == nullptr) return;
  for (int i = 0; i < robot.joints; ++i) f[i] = V{};
  forEachCoupling(robot, [&](double c, int m, int i) FAST_LAMBDA { f[i] += c * of_laws[m]; });
}

/// torques += factor f.
template <typename V>
FAST_APART void addChangingFriction(const Robot& robot, int structure, const State<V>& state,
                                    double factor, V* torques) {
  V f[kJointSpace];
  changingFriction(robot, structure, state, f);
  for (int i = 0; i < robot.joints; ++i) torques[i] += factor * f[i];
}

/// Derivatives by q and qd of the torques += those of friction.
template <typename V>
FAST_APART void addChangingFrictionDerivatives(const Robot& robot, int structure,
                                               const State<V>& state,
                                               const DerivativeEntries<V>& to) {
  V g[kLawSpace], v[kLawSpace], of_laws[kLawSpace];
  loadOf(robot, structure, state, g);
  const V* const velocities = lawVelocities(robot, state.qd, v);
  forEachLaw(robot, velocities, of_laws,
             [&](const auto& qd, const auto& law, int joint) FAST_LAMBDA {
               const auto changing = heightOf(qd, atJoint(g, joint), law);
               return frictionSlopeOf(qd, changing.height, law) + changing.slope * stepOf(qd, law);
             });
  if (robot.coupling == nullptr) {
    for (int i = 0; i < robot.joints; ++i) to.by_qd[i + i * to.outer_step] += of_laws[i];
  } else {
    forEachCoupling(robot, [&](double c, int m, int i) FAST_LAMBDA {
      for (int j = 0; j < robot.joints; ++j) {
        const double both = c * robot.coupling[m * robot.joints + j];
        if (both != 0.0) to.by_qd[i + j * to.outer_step] += both * of_laws[m];
      }
    });
  }
  if (!robot.load_friction) return;

  // df/dq = df/dg dg/dq; of laws that act on several joints, none depends on load
  forEachLaw(robot, velocities, of_laws,
             [&](const auto& qd, const auto& law, int joint)
                 FAST_LAMBDA { return law.fl * signOf(atJoint(g, joint)) * stepOf(qd, law); });
  addLoadDerivatives<AnyWithMatrices<V>>(robot, state, of_laws, to.by_q, to.outer_step);
}

/// Friction torques of one state; f has room for a pack at the end.
inline void frictionOfJoints(const Robot& robot, int structure, const State<double>& state,
                             double* f) {
  if (robot.changing_steps) return changingFriction(robot, structure, state, f);
  forEachLaw(robot, state.qd, f, [](const Short& qd, const auto& law, int) FAST_LAMBDA {
    return frictionOf(qd, law.A, law);
  });
}

// Where the heights of the steps don't change; slopes has room for a pack at the end.
inline void frictionSlopes(const Robot& robot, const double* qd, double* slopes) {
  forEachLaw(robot, qd, slopes, [](const Short& x, const auto& law, int) FAST_LAMBDA {
    return frictionSlopeOf(x, law.A, law);
  });
}

FAST_INLINE Pack frictionOfPack(const Robot& robot, int i, const Pack& qd) {
  if (robot.friction == nullptr) return 0.0 * qd;
  const FrictionNumbers<Pack> law = lawOfPack(robot, i);
  return frictionOf(qd, law.A, law);
}

FAST_INLINE Pack frictionSlopeOfPack(const Robot& robot, int i, const Pack& qd) {
  const FrictionNumbers<Pack> law = lawOfPack(robot, i);
  return frictionSlopeOf(qd, law.A, law);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
