// SPDX-License-Identifier: Apache-2.0

/// @file
/// Sine, cosine and the logistic function of a pack.
///
/// Included by the kernels' two sources only [pack.hpp].

#pragma once

#include <math.h>  // NOLINT(modernize-deprecated-headers): <cmath> has inline functions

#include "pack.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

// Up to this many quarter turns (1.6e6 rad) the parts of pi/2 below times their number are exact;
// beyond it the C library's functions take over.
constexpr long long kMostQuarterTurns = 1 << 20;

// pi/2 in three parts, the first two of 33 bits.
constexpr double kHalfPi1 = 0x1.921fb544p+0;
constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;

// A number added and taken away again rounds to an integer, which stands in its lowest bits.
constexpr double kRound = 0x1.8p52;

constexpr long long kSign = static_cast<long long>(0x8000000000000000);

// How a polynomial is evaluated: with the fewest instructions, where there are many to evaluate, or
// with the shortest chain of them.
enum class Scheme { kHorner, kEstrin };

// c0 + c1 z + ... + c5 z^5
template <Scheme How, typename V>
FAST_INLINE V polynomial(const V& z, double c0, double c1, double c2, double c3, double c4,
                         double c5) {
  if constexpr (How == Scheme::kHorner) {
    return c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * c5))));
  } else {
    const V z2 = z * z;
    return (c0 + z * c1) + z2 * (c2 + z * c3) + (z2 * z2) * (c4 + z * c5);
  }
}

// Sine and cosine of angle + quarter_turns pi/2, to 1.2e-16 (about one unit in the last place of
// one). Adds to `beyond` where they aren't right yet: anyBeyond(). NaN gives NaN.
template <Scheme How, typename V>
FAST_INLINE void sineCosine(const V& angle, const V& quarter_turns, V& sine, V& cosine,
                            BitsOf<V>& beyond) {
  using Bits = BitsOf<V>;

  // angle = k pi/2 + r, r within pi/4
  const V rounded = angle * kTwoOverPi + kRound;
  const V k = rounded - kRound;
  const V r = ((angle - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3;

  // Taylor-like polynomials, minimax on this interval, in z = r^2
  const V z = r * r;
  const V sin_tail = polynomial<How>(z, -1.66666666666666324348e-01, 8.33333333332248946124e-03,
                                     -1.98412698298579493134e-04, 2.75573137070700676789e-06,
                                     -2.50507602534068634195e-08, 1.58969099521155010221e-10);
  const V cos_tail = polynomial<How>(z, 4.16666666666666019037e-02, -1.38888888888741095749e-03,
                                     2.48015872894767294178e-05, -2.75573143513906633035e-07,
                                     2.08757232129817482790e-09, -1.13596475577881948265e-11);
  const V sin_r = r + (r * z) * sin_tail;
  const V cos_r = 1.0 - z * (0.5 - z * cos_tail);

  // each quarter turn makes (sine, cosine) into (cosine, -sine); the lowest bits stand for them
  const Bits turns = reinterpret_cast<Bits>(rounded + quarter_turns);
  const Bits odd = turns << 63;
  const Bits sine_sign = (turns << 62) & kSign;
  const V s = odd < 0 ? cos_r : sin_r;
  const V c = odd < 0 ? sin_r : cos_r;
  sine = reinterpret_cast<V>(reinterpret_cast<Bits>(s) ^ sine_sign);
  cosine = reinterpret_cast<V>(reinterpret_cast<Bits>(c) ^ sine_sign ^ odd);

  // k + kMostQuarterTurns: no bit above those of twice as many, if k is small enough
  constexpr long long kRoundBits = 0x4338000000000000;
  beyond |= reinterpret_cast<Bits>(rounded) + (kMostQuarterTurns - kRoundBits);
}

// Whether sines and cosines that were added to `beyond` are for the C library.
template <typename V>
FAST_INLINE bool anyBeyond(const BitsOf<V>& beyond) {
  unsigned long long bits = 0;
  for (int lane = 0; lane < kLanes<V>; ++lane)
    bits |= static_cast<unsigned long long>(beyond[lane]);
  return bits >= 2 * kMostQuarterTurns;
}

// By the C library where an angle is beyond; the others keep their bits. `repeated` angles in turn
// have one entry of quarter_turns.
__attribute__((noinline, cold)) void sineCosineBeyond(int count, const double* angle,
                                                      const double* quarter_turns, int repeated,
                                                      double* sine, double* cosine) {
  for (int k = 0; k < count; ++k) {
    Short ignored_sine;
    Short ignored_cosine;
    ShortBits beyond{};
    const auto x = all<Short>(angle[k]);
    sineCosine<Scheme::kHorner>(x, x, ignored_sine, ignored_cosine, beyond);
    if (!anyBeyond<Short>(beyond)) continue;
    const double s = sin(angle[k]);
    const double c = cos(angle[k]);
    const int turns = static_cast<int>(quarter_turns[k / repeated]) & 3;
    sine[k] = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
    cosine[k] = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
  }
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
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics
