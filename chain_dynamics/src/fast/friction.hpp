// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction torques of all joints, of one state or of a pack of states.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include "turns.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

// number(k) is the k-th of kFrictionNumbers.
template <typename V, typename Number>
FAST_INLINE V frictionOf(const V& qd, const Number& number) {
  const V zero{};
  const V one = all<V>(1.0);
  const V sign = (qd > 0.0 ? one : zero) - (qd < 0.0 ? one : zero);
  return number(0) * qd + (number(1) * sign + number(2)) +
         number(3) * (sigmoid<V>(number(4) * (qd + number(5))) - number(6));
}

// Its derivative by qd; none at the jump of sign(qd).
template <typename V, typename Number>
FAST_INLINE V frictionSlopeOf(const V& qd, const Number& number) {
  const V x = number(4) * (qd + number(5));
  const V e = expOfMinus<V>(x < 0.0 ? -x : x);
  return number(0) + (number(3) * number(4)) * (e / ((1.0 + e) * (1.0 + e)));
}

// of(qd, numbers of the law) for all joints; result has room for a pack at the end.
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
    store(of(load<Short>(from), number), result + first);
  }
}

inline void frictionNumbers(const Robot& robot, const double* qd, double* f) {
  forEachLaw(robot, qd, f,
             [](const Short& x, const auto& number) FAST_LAMBDA { return frictionOf(x, number); });
}

inline void frictionSlopes(const Robot& robot, const double* qd, double* slopes) {
  forEachLaw(robot, qd, slopes, [](const Short& x, const auto& number) FAST_LAMBDA {
    return frictionSlopeOf(x, number);
  });
}

inline void frictionOfState(const Robot& robot, const double* qd, double* f) {
  if (robot.friction == nullptr) {
    for (int i = 0; i < robot.joints; ++i) f[i] = 0.0 * qd[i];  // keeps a NaN
    return;
  }
  JointNumbers numbers;
  frictionNumbers(robot, qd, numbers.values);
  for (int i = 0; i < robot.joints; ++i) f[i] = numbers.values[i];
}

FAST_INLINE Pack frictionOfPack(const Robot& robot, int i, const Pack& qd) {
  if (robot.friction == nullptr) return 0.0 * qd;
  return frictionOf(qd, [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); });
}

FAST_INLINE Pack frictionSlopeOfPack(const Robot& robot, int i, const Pack& qd) {
  return frictionSlopeOf(qd,
                         [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
