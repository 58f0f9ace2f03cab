// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a friction law is made of: coefficients with names, and one form that all laws share.
///
///     for (const auto& coefficient : SmoothCoulomb::coefficients()) law.*coefficient.value = 0.5;
///
/// A law is a struct of coefficients in a file of its own, with
///
///     static constexpr const char* kName;               // its name in model files
///     static constexpr int kSchema;                     // the first schema of model files with it
///     static constexpr std::array<...> coefficients();  // by name, and what they may be
///     FrictionForm form() const;                        // the law in the form below
///
/// and its name in FrictionLaw [friction.hpp]. Reading, checking, scaling, torques, derivatives and
/// the fast kernels are made of these.

#pragma once

namespace chain_dynamics {
inline namespace v2 {

/// What a coefficient may be, besides finite.
enum class CoefficientRange { kAny, kNotNegative, kPositive };

/// One coefficient of a law.
template <class Law>
struct Coefficient {
  const char* name;    ///< its key in a model file
  double Law::*value;  ///< where it is
  bool is_torque;      ///< follows the unit of torque: N m, N m s/rad
  CoefficientRange range = CoefficientRange::kAny;
  bool required = true;
  /// Of an optional one: required where the coefficient of this name is given; without meaning, of
  /// any value, where that one is zero.
  const char* required_with = nullptr;
};

/// Every law in one form, that of the fast kernels:
///
///     f = fv qd + fc sign(qd) + fo + B (sigmoid(alpha (qd + shift)) - center),
///     B = A + fl |g| + fs exp(-(qd / vs)^2),    sigmoid(x) = 1 / (1 + exp(-x)).
struct FrictionForm {
  double fv = 0;      ///< viscous coefficient [N m s/rad]
  double fc = 0;      ///< jump at rest, each way [N m]
  double fo = 0;      ///< offset [N m]
  double A = 0;       ///< height of the smooth step [N m]
  double alpha = 0;   ///< its steepness [s/rad]
  double shift = 0;   ///< the step is at qd = -shift [rad/s]
  double center = 0;  ///< part of the step that is taken off: 1/2 makes it symmetric
  double fl = 0;      ///< what a gravity torque of 1 N m adds to the height of the step; >= 0
  double fs = 0;      ///< what the Stribeck effect adds at rest [N m]
  double per_vs = 0;  ///< 1 / vs [s/rad]
};

}  // namespace v2
}  // namespace chain_dynamics
