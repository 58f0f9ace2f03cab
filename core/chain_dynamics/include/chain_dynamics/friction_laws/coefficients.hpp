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
/// the fast kernels are made of these. A law that the form can't express needs one more of
/// FrictionNumbers, and the formula with it in friction.hpp and src/fast/friction.hpp: torque and slope.

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

/// The numbers of a law in the form below: of one law, or in the fast kernels of several side by side.
template <typename Number>
struct FrictionNumbers {
  Number fv;      ///< viscous coefficient [N m s/rad]
  Number fc;      ///< jump at rest, each way [N m]
  Number fo;      ///< offset [N m]
  Number A;       ///< height of the smooth step [N m]
  Number alpha;   ///< its steepness [s/rad]
  Number shift;   ///< the step is at qd = -shift [rad/s]
  Number center;  ///< part of the step that is taken off: 1/2 makes it symmetric
  Number fl;      ///< what a gravity torque of 1 N m adds to the height of the step; >= 0
  Number fs;      ///< what the Stribeck effect adds at rest, of either sign [N m]
  Number per_vs;  ///< 1 / vs [s/rad]
};

/// Every law in one form, that of the fast kernels:
///
///     f = fv qd + fc sign(qd) + fo + B (sigmoid(alpha (qd + shift)) - center),
///     B = A + fl |g| + fs exp(-(qd / vs)^2),    sigmoid(x) = 1 / (1 + exp(-x)).
struct FrictionForm : FrictionNumbers<double> {
  /// No friction.
  FrictionForm() : FrictionNumbers() {}
};

}  // namespace v2
}  // namespace chain_dynamics
