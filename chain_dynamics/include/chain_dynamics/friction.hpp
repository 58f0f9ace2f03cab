// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joint friction: what a motor must add, in a given state, to what rigid bodies ask for.
///
///     FrictionLaw law = CenteredSigmoid{0.54615, 5.1181, 0.039533};  // amplitude, slope, shift
///     double f = friction(law, 0.3, 0.0);                            // N m at 0.3 rad/s
///     frictionVector(laws, qd, g, f_vector);                         // one law per joint
///
/// Sign: f enters `tau = H qdd + C qd + f + g`, so it is positive for positive velocities where
/// friction brakes.
///
/// Friction of a joint depends on its velocity qd and, with laws that have a load coefficient, on
/// |g|, the gravity torque that the joint carries.
///
/// Real time: all functions but checkFriction(): no allocation, lock, exception or system call.
/// Threads: safe.
///
/// A new law is a small file in friction_laws/ [friction_laws/coefficients.hpp says what to write]
/// and one more name in FrictionLaw.

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "chain_dynamics/friction_laws/centered_sigmoid.hpp"
#include "chain_dynamics/friction_laws/sigmoid.hpp"
#include "chain_dynamics/friction_laws/smooth_coulomb.hpp"
#include "chain_dynamics/friction_laws/viscous_coulomb_offset.hpp"
#include "chain_dynamics/friction_laws/viscous_offset_sigmoid.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Friction of one joint: one of the named laws. ViscousCoulombOffset{} is no friction at all.
using FrictionLaw =
    std::variant<ViscousCoulombOffset, ViscousOffsetSigmoid, CenteredSigmoid, SmoothCoulomb>;

/// The law in the form that all laws share.
inline FrictionForm formOf(const FrictionLaw& law) {
  return std::visit([](const auto& named) { return named.form(); }, law);
}

namespace internal {

// Multiples of vs beyond which nothing is left of the Stribeck effect: exp(-400) = 2e-174.
constexpr double kBeyondStribeck = 20;

// Height B of the step, and its derivatives by qd and by |g|.
struct StepHeight {
  double height, by_velocity, by_load;
};

inline StepHeight stepHeight(const FrictionForm& form, double qd, double g) {
  StepHeight B{form.A, 0, form.fl};
  if (form.fl != 0) B.height += form.fl * std::abs(g);
  if (form.fs != 0) {
    const double u = std::clamp(qd * form.per_vs, -kBeyondStribeck, kBeyondStribeck);
    const double stribeck = form.fs * std::exp(-u * u);
    B.height += stribeck;
    B.by_velocity = -2 * form.per_vs * u * stribeck;
  }
  return B;
}

inline bool hasStep(const FrictionForm& form) {
  return form.A != 0 || form.fl != 0 || form.fs != 0;
}

}  // namespace internal

/// Friction torque [N m] of a law at the velocity qd [rad/s] under the gravity torque g [N m]. NaN
/// for NaN; finite for finite numbers.
///
/// @param g  not used by laws without a load coefficient: dependsOnLoad().
inline double friction(const FrictionForm& law, double qd, double g) {
  const double sign = qd > 0 ? 1.0 : (qd < 0 ? -1.0 : 0.0);
  const double f = law.fv * qd + law.fc * sign + law.fo;  // NaN stays: 0 * NaN is NaN
  if (!internal::hasStep(law)) return f;
  const double step = sigmoid(law.alpha * (qd + law.shift)) - law.center;
  return f + internal::stepHeight(law, qd, g).height * step;
}

/// @copydoc friction(const FrictionForm&, double, double)
inline double friction(const FrictionLaw& law, double qd, double g) {
  return friction(formOf(law), qd, g);
}

/// The derivative `df/dqd` [N m s/rad] of a law at the velocity qd [rad/s] under the gravity torque
/// g [N m]. NaN for NaN.
///
/// A jump (Coulomb friction at rest) has none and counts as nothing.
inline double frictionSlope(const FrictionForm& law, double qd, double g) {
  if (std::isnan(qd)) return qd;
  if (!internal::hasStep(law)) return law.fv;
  const double x = law.alpha * (qd + law.shift);
  const internal::StepHeight B = internal::stepHeight(law, qd, g);
  return law.fv + B.by_velocity * (sigmoid(x) - law.center) +
         B.height * law.alpha * sigmoid(x) * sigmoid(-x);
}

/// @copydoc frictionSlope(const FrictionForm&, double, double)
inline double frictionSlope(const FrictionLaw& law, double qd, double g) {
  return frictionSlope(formOf(law), qd, g);
}

/// The derivative `df/dg` [1] of a law at the velocity qd [rad/s] by the gravity torque g [N m]; zero
/// at g = 0, where |g| has none.
inline double frictionLoadSlope(const FrictionForm& law, double qd, double g) {
  if (law.fl == 0 || g == 0) return 0;
  const double step = sigmoid(law.alpha * (qd + law.shift)) - law.center;
  return std::copysign(law.fl, g) * step;
}

/// @copydoc frictionLoadSlope(const FrictionForm&, double, double)
inline double frictionLoadSlope(const FrictionLaw& law, double qd, double g) {
  return frictionLoadSlope(formOf(law), qd, g);
}

/// Whether friction depends on the gravity torque.
inline bool dependsOnLoad(const FrictionLaw& law) { return formOf(law).fl != 0; }

/// The same law in another unit of torque: from motor currents [A] to torques by a drive gain
/// [N m/A]. `friction(scaled(law, k), qd, k g) = k friction(law, qd, g)`.
FrictionLaw scaled(const FrictionLaw& law, double factor);

/// Rejects a law with a coefficient out of its range, or one that isn't finite.
///
/// @param where  what messages call the law's place.
/// @throws ModelError  naming law and coefficient.
void checkFriction(const FrictionLaw& law, const std::string& where);

/// Friction torques of all joints: `f_j = friction(laws[j], qd_j, g_j)`.
///
/// @param laws    one per joint.
/// @param qd      n; rad/s (prismatic m/s).
/// @param g       n; gravity torques, N m (prismatic N); where no law depends on load, may be empty.
/// @param[out] f  n; N m (prismatic N).
void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> f);

/// Their derivatives: `slope_j = frictionSlope(laws[j], qd_j, g_j)`, the diagonal of `df/dqd`.
///
/// @param laws        one per joint.
/// @param qd          n; rad/s (prismatic m/s).
/// @param g           n; gravity torques, N m (prismatic N); where no law depends on load, may be
///                    empty.
/// @param[out] slope  n; N m s/rad (prismatic N s/m).
void frictionSlopes(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> slope);

}  // namespace v2
}  // namespace chain_dynamics
