// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction torques of all joints, of one state or of a pack of states.
///
/// The heights of the steps are constants of most robots. Where one changes with load or velocity,
/// all joints are computed by the functions whose names begin with `changing`, which aren't inlined.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

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

// number(k) is the k-th of kFrictionNumbers. Part of the step that is behind at this velocity.
template <typename V, typename Number>
FAST_INLINE V stepOf(const V& qd, const Number& number) {
  return sigmoid<V>(number(4) * (qd + number(5))) - number(6);
}

template <typename V, typename Number>
FAST_INLINE V frictionOf(const V& qd, const V& height, const Number& number) {
  return number(0) * qd + (number(1) * signOf(qd) + number(2)) + height * stepOf(qd, number);
}

// Its derivative by qd, of a constant height; none at the jump of sign(qd).
template <typename V, typename Number>
FAST_INLINE V frictionSlopeOf(const V& qd, const V& height, const Number& number) {
  const V x = number(4) * (qd + number(5));
  const V e = expOfMinus<V>(x < 0.0 ? -x : x);
  return number(0) + (height * number(4)) * (e / ((1.0 + e) * (1.0 + e)));
}

// Height of the step under a gravity torque, and its derivative by qd.
template <typename V>
struct ChangingHeight {
  V height, slope;
};

template <typename V, typename Number>
FAST_INLINE ChangingHeight<V> heightOf(const V& qd, const V& g, const Number& number) {
  // 20: nothing is left of exp(-400)
  const V most = all<V>(20.0);
  V u = qd * number(9);
  u = u > 20.0 ? most : u;
  u = u < -20.0 ? -most : u;
  // 1e-40: powers of the square of a velocity of 1e-100 rad/s would be denormal
  const V stribeck = number(8) * expOfMinus<V>(u * u + 1e-40);
  // (a joint without load friction doesn't see a NaN of the others)
  const V zero{};
  const V load = number(7) > 0.0 ? number(7) * (g < 0.0 ? -g : g) : zero;
  return {number(3) + (load + stribeck), -2.0 * number(9) * (u * stribeck)};
}

// of(qd, numbers of the law, joint) for all joints; result has room for a pack at the end.
template <typename Of>
FAST_INLINE void forEachLaw(const Robot& robot, const double* qd, double* result, const Of& of) {
  const int n = robot.joints;
  double padded[kShortWidth] = {};
  for (int i = 0; i < n; i += kShortWidth) {
    const int first = firstOfPack(i, n);
    const double* from = qd + first;
    if (n < kShortWidth) {
      for (int j = 0; j < n; ++j) padded[j] = qd[j];
      from = padded;
    }
    const auto number = [&](int k) {
      return load<Short>(robot.friction + std::ptrdiff_t{k} * robot.stride + first);
    };
    store(of(load<Short>(from), number, first), result + first);
  }
}
template <typename Of>
FAST_INLINE void forEachLaw(const Robot& robot, const Pack* qd, Pack* result, const Of& of) {
  for (int i = 0; i < robot.joints; ++i) {
    const auto number = [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); };
    result[i] = of(qd[i], number, i);
  }
}

FAST_INLINE Short atJoint(const double* numbers, int joint) { return load<Short>(numbers + joint); }
FAST_INLINE const Pack& atJoint(const Pack* numbers, int joint) { return numbers[joint]; }

/// Joints, with room for a pack at the end.
constexpr int kJointSpace = kMaxJoints + kShortWidth;

/// Gravity torques where friction depends on them; else zeros.
template <typename V>
FAST_INLINE void loadOf(const Robot& robot, int structure, const State<V>& state, V* g) {
  for (int i = 0; i < kJointSpace; ++i) g[i] = V{};
  if (robot.load_friction) recursionsOf<V>(structure).gravity(robot, state, g);
}

template <typename V>
FAST_APART void changingFriction(const Robot& robot, int structure, const State<V>& state, V* f) {
  V g[kJointSpace];
  loadOf(robot, structure, state, g);
  forEachLaw(robot, state.qd, f, [&](const auto& qd, const auto& number, int joint) FAST_LAMBDA {
    return frictionOf(qd, heightOf(qd, atJoint(g, joint), number).height, number);
  });
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
  V g[kJointSpace];
  V of_joints[kJointSpace];
  loadOf(robot, structure, state, g);
  forEachLaw(
      robot, state.qd, of_joints, [&](const auto& qd, const auto& number, int joint) FAST_LAMBDA {
        const auto changing = heightOf(qd, atJoint(g, joint), number);
        return frictionSlopeOf(qd, changing.height, number) + changing.slope * stepOf(qd, number);
      });
  for (int i = 0; i < robot.joints; ++i) to.by_qd[i + i * to.outer_step] += of_joints[i];
  if (!robot.load_friction) return;

  // df/dq = df/dg dg/dq
  forEachLaw(robot, state.qd, of_joints,
             [&](const auto& qd, const auto& number, int joint) FAST_LAMBDA {
               return number(7) * signOf(atJoint(g, joint)) * stepOf(qd, number);
             });
  addLoadDerivatives<AnyWithMatrices<V>>(robot, state, of_joints, to.by_q, to.outer_step);
}

// Where the heights of the steps don't change, of one state; result has room for a pack at the end.
inline void frictionNumbers(const Robot& robot, const double* qd, double* f) {
  forEachLaw(robot, qd, f, [](const Short& x, const auto& number, int) FAST_LAMBDA {
    return frictionOf(x, number(3), number);
  });
}

inline void frictionSlopes(const Robot& robot, const double* qd, double* slopes) {
  forEachLaw(robot, qd, slopes, [](const Short& x, const auto& number, int) FAST_LAMBDA {
    return frictionSlopeOf(x, number(3), number);
  });
}

FAST_INLINE Pack frictionOfPack(const Robot& robot, int i, const Pack& qd) {
  if (robot.friction == nullptr) return 0.0 * qd;
  const auto number = [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); };
  return frictionOf(qd, number(3), number);
}

FAST_INLINE Pack frictionSlopeOfPack(const Robot& robot, int i, const Pack& qd) {
  const auto number = [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); };
  return frictionSlopeOf(qd, number(3), number);
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
