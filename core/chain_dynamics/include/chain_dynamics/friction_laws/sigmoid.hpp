// SPDX-License-Identifier: Apache-2.0

/// @file
/// The step of smooth friction laws: the logistic function
///
///     sigmoid(x) = 1 / (1 + exp(-x)),      0 for x -> -inf, 1/2 at x = 0, 1 for x -> +inf,
///     tanh(x) = 2 sigmoid(2 x) - 1.
///
/// It stands for the jump of Coulomb friction: a factor `alpha` of the velocity says how steep it is
/// [s/rad], a shift where it is. Identified slopes reach hundreds of s/rad, so exp(-alpha (qd + nu))
/// overflows within the velocities of a robot. It is therefore computed with the exponent that
/// can't be positive: for x < 0 as exp(x) / (1 + exp(x)).

#pragma once

#include <cmath>

namespace chain_dynamics {
inline namespace v2 {

/// The logistic function `1 / (1 + exp(-x))`, without overflow for any x; NaN gives NaN.
///
/// @tparam Number  double or a dual number.
template <typename Number>
Number sigmoid(const Number& x) {
  using std::abs;
  using std::exp;
  const Number e = exp(-abs(x));  // never above one
  return (x < Number(0) ? e : Number(1)) / (Number(1) + e);
}

}  // namespace v2
}  // namespace chain_dynamics
