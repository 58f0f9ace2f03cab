// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a friction law is made of: figures with names, and one form that all laws share.
///
///     for (const auto& figure : SmoothCoulomb::figures()) law.*figure.value = 0.5;
///
/// A law is a struct of figures in a file of its own, with
///
///     static constexpr const char* kName;             // what a model file calls it
///     static constexpr int kSchema;                   // since which schema a model file may have it
///     static constexpr std::array<...> figures();     // the figures by name, and what they may be
///     FrictionForm form() const;                      // the law in the form below
///
/// and its name in FrictionLaw [friction.hpp]. Reading, checking, scaling, torques, derivatives and
/// the fast kernels are made of these.

#pragma once

namespace chain_dynamics {
inline namespace v2 {

/// What a figure may be, besides finite.
enum class FigureRange { kAny, kNotNegative, kPositive };

/// One figure of a law.
template <class Law>
struct Figure {
  const char* name;    ///< its key in a model file
  double Law::*value;  ///< where it is
  bool is_torque;      ///< follows the unit of torque: N m, N m s/rad
  FigureRange range = FigureRange::kAny;
  bool required = true;
  /// For an optional one: required where the figure of this name is given; has no meaning, and may
  /// have any value, where that one is zero.
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
