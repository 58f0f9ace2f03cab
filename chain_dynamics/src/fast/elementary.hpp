// SPDX-License-Identifier: Apache-2.0

/// @file
/// Sine, cosine and the logistic function of a pack.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include <math.h>  // NOLINT(modernize-deprecated-headers): <cmath> has inline functions

#include "pack.hpp"

namespace chain_dynamics::fast {
namespace {

// Up to here the parts of pi/2 below times the number of quarter turns are exact; beyond it the C
// library's functions take over.
constexpr double kLargestAngle = 1e6;

// pi/2 in three parts, the first two of 33 bits.
constexpr double kHalfPi1 = 0x1.921fb544p+0;
constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;

// A number added and taken away again rounds to an integer, which stands in its lowest bits.
constexpr double kRound = 0x1.8p52;

// Sine and cosine of angle + quarter_turns pi/2, to 1.2e-16 (about one unit in the last place of
// one). Returns lanes with angles beyond kLargestAngle, which aren't right yet. NaN gives NaN.
template <typename V>
FAST_INLINE BitsOf<V> sineCosine(const V& angle, const V& quarter_turns, V& sine, V& cosine) {
  using Bits = BitsOf<V>;

  // angle = k pi/2 + r, r within pi/4
  const V rounded = angle * kTwoOverPi + kRound;
  const V k = rounded - kRound;
  const V r = ((angle - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3;

  // Taylor-like polynomials, minimax on this interval, in z = r^2
  const V z = r * r;
  const V z2 = z * z;
  const V z4 = z2 * z2;
  const V sin_tail = (z * 8.33333333332248946124e-03 - 1.66666666666666324348e-01) +
                     z2 * (z * 2.75573137070700676789e-06 - 1.98412698298579493134e-04) +
                     z4 * (z * 1.58969099521155010221e-10 - 2.50507602534068634195e-08);
  const V cos_tail = (z * -1.38888888888741095749e-03 + 4.16666666666666019037e-02) +
                     z2 * (z * -2.75573143513906633035e-07 + 2.48015872894767294178e-05) +
                     z4 * (z * -1.13596475577881948265e-11 + 2.08757232129817482790e-09);
  const V sin_r = r + (r * z) * sin_tail;
  const V cos_r = 1.0 - (z * 0.5 - z2 * cos_tail);

  // each quarter turn makes (sine, cosine) into (cosine, -sine)
  const V turned = rounded + quarter_turns;
  Bits turns;
  __builtin_memcpy(&turns, &turned, sizeof(turns));
  const Bits swapped = 0 - (turns & 1);
  const V s = swapped ? cos_r : sin_r;
  const V c = swapped ? sin_r : cos_r;
  const Bits sine_sign = (turns & 2) << 62;
  const Bits cosine_sign = ((turns + 1) & 2) << 62;
  sine = reinterpret_cast<V>(reinterpret_cast<Bits>(s) ^ sine_sign);
  cosine = reinterpret_cast<V>(reinterpret_cast<Bits>(c) ^ cosine_sign);
  return (angle > kLargestAngle) | (angle < -kLargestAngle);
}

// The same for angles of any size, by the C library.
__attribute__((noinline, cold)) void sineCosineOfAny(double angle, double quarter_turns,
                                                     double& sine, double& cosine) {
  const double s = sin(angle);
  const double c = cos(angle);
  const int turns = static_cast<int>(quarter_turns) & 3;
  sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
  cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
}

// exp(-x) for x >= 0, where more than 708 count as 708 (3e-308); NaN gives NaN.
template <typename V>
FAST_INLINE V expOfMinus(V x) {
  using Bits = BitsOf<V>;
  constexpr double kLog2e = 0x1.71547652b82fep+0;
  constexpr double kLn2High = 0x1.62e42fee00000p-1;
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  x = x > 708.0 ? all<V>(708.0) : x;

  // -x = k ln 2 + r, r within ln 2 / 2
  const V rounded = x * -kLog2e + kRound;
  const V k = rounded - kRound;
  const V r = (-x - k * kLn2High) - k * kLn2Low;

  // exp(r) = 1 + r + r^2 / 2 + ... + r^13 / 13!
  const V r2 = r * r;
  const V r4 = r2 * r2;
  const V low = (1.0 / 2 + r * (1.0 / 6)) + r2 * (1.0 / 24 + r * (1.0 / 120));
  const V middle = (1.0 / 720 + r * (1.0 / 5040)) + r2 * (1.0 / 40320 + r * (1.0 / 362880));
  const V high =
      (1.0 / 3628800 + r * (1.0 / 39916800)) + r2 * (1.0 / 479001600 + r * (1.0 / 6227020800));
  const V e = 1.0 + (r + r2 * (low + r4 * (middle + r4 * high)));

  // times 2^k: k is added to the exponent
  const Bits exponent = reinterpret_cast<Bits>(rounded) << 52;
  return reinterpret_cast<V>(reinterpret_cast<Bits>(e) + exponent);
}

// 1 / (1 + exp(-x)), with the exponent that can't be positive.
template <typename V>
FAST_INLINE V sigmoid(const V& x) {
  const V e = expOfMinus<V>(x < 0.0 ? -x : x);
  return (x < 0.0 ? e : all<V>(1.0)) / (1.0 + e);
}

}  // namespace
}  // namespace chain_dynamics::fast
