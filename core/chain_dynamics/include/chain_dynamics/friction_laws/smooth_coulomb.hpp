// SPDX-License-Identifier: Apache-2.0

/// @file
/// Smooth Coulomb friction that may grow with load and near rest, and may preslide:
/// `f = fv qd + fo + (fc + fm + fl |g(q)| + fs exp(-(qd / vs)^2)) tanh((qd + shift) / width)`.

#pragma once

#include <array>

#include "chain_dynamics/friction_laws/coefficients.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `f = fv qd + fo + (fc + fm + fl |g(q)| + fs exp(-(qd / vs)^2)) tanh((qd + shift) / width)`.
///
/// This is the limit without memory. With a distance, the parts fm and fs lag behind a reversal, over
/// the distance that a gear yields [friction_state.hpp].
///
/// g(q) is the gravity torque of the joint, of the robot as it is: with its payload, under its
/// gravity; an external wrench doesn't count. Gears rub more where they carry more; near rest, the
/// lubricant is squeezed out (Stribeck) [Bittencourt et al. 2010, An extended friction model to
/// capture load and temperature effects in robot joints, IROS]. Without shift and offset f brakes at
/// every velocity, and without fs it grows with velocity.
struct SmoothCoulomb {
  double fv = 0;     ///< viscous coefficient [N m s/rad] (prismatic: N s/m), >= 0
  double fc = 0;     ///< Coulomb friction [N m] (prismatic: N), >= 0
  double width = 1;  ///< of the step [rad/s], > 0: tanh(1) = 76 % of it at qd = width - shift
  double shift = 0;  ///< the step is at qd = -shift [rad/s]
  double fo = 0;     ///< offset [N m] (prismatic: N), at rest too
  double fl = 0;     ///< load coefficient [1], >= 0: friction per gravity torque
  double fs = 0;     ///< what friction is greater by at rest (Stribeck) [N m] (prismatic: N), >= 0
  double vs = 0;     ///< velocity at which 1/e of fs is left [rad/s], > 0; without fs not used
  double fm = 0;     ///< presliding friction [N m] (prismatic: N), >= 0
  double distance = 0;  ///< that it takes to turn round [rad] (prismatic: m); 0: none, and no fm

  static constexpr const char* kName = "smooth_coulomb";
  static constexpr int kSchema = 2;

  static constexpr std::array<Coefficient<SmoothCoulomb>, 10> coefficients() {
    constexpr auto kNotNegative = CoefficientRange::kNotNegative;
    constexpr auto kPositive = CoefficientRange::kPositive;
    return {{{"fv", &SmoothCoulomb::fv, true, kNotNegative},
             {"fc", &SmoothCoulomb::fc, true, kNotNegative},
             {"width", &SmoothCoulomb::width, false, kPositive},
             {"shift", &SmoothCoulomb::shift, false, CoefficientRange::kAny, false},
             {"fo", &SmoothCoulomb::fo, true, CoefficientRange::kAny, false},
             {"fl", &SmoothCoulomb::fl, false, kNotNegative, false},
             {"fs", &SmoothCoulomb::fs, true, kNotNegative, false},
             {"vs", &SmoothCoulomb::vs, false, kPositive, false, "fs"},
             {"fm", &SmoothCoulomb::fm, true, kNotNegative, false},
             {"distance", &SmoothCoulomb::distance, false, kPositive, false, "fm"}}};
  }

  FrictionForm form() const {
    FrictionForm form;  // tanh(x) = 2 sigmoid(2 x) - 1
    form.fv = fv;
    form.fo = fo;
    form.A = 2 * (fc + fm);
    form.alpha = 2 / width;
    form.shift = shift;
    form.center = 0.5;
    form.fl = 2 * fl;
    form.fs = 2 * fs;
    if (fs != 0) form.per_vs = 1 / vs;
    return form;
  }
};

}  // namespace v2
}  // namespace chain_dynamics
