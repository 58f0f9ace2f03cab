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

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/friction_laws/centered_sigmoid.hpp"
#include "chain_dynamics/friction_laws/sigmoid.hpp"
#include "chain_dynamics/friction_laws/smooth_coulomb.hpp"
#include "chain_dynamics/friction_laws/viscous_coulomb_offset.hpp"
#include "chain_dynamics/friction_laws/viscous_offset_sigmoid.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Most laws of one robot.
constexpr Eigen::Index kMostFrictionLaws = 128;

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

}  // namespace internal

/// Friction torque [N m] of a law at the velocity qd [rad/s] under the gravity torque g [N m]. NaN
/// for NaN; finite for finite numbers.
///
/// @tparam Number  double or a dual number.
/// @param g  not used by laws without a load coefficient: dependsOnLoad().
template <typename Number>
Number friction(const FrictionForm& law, const Number& qd, const Number& g) {
  using std::abs;
  using std::exp;
  const double sign = qd > Number(0) ? 1.0 : (qd < Number(0) ? -1.0 : 0.0);
  Number f = law.fv * qd + law.fc * sign + law.fo;  // NaN stays: 0 * NaN is NaN
  Number height = law.A;
  if (law.fl != 0) height += law.fl * abs(g);
  if (law.fs != 0) {
    const Number most = internal::kBeyondStribeck;
    const Number u = std::clamp<Number>(qd * law.per_vs, -most, most);
    height += law.fs * exp(-u * u);
  }
  if (law.A != 0 || law.fl != 0 || law.fs != 0) {
    f += height * (sigmoid(law.alpha * (qd + law.shift)) - law.center);
  }
  return f;
}

/// @copydoc friction(const FrictionForm&, const Number&, const Number&)
inline double friction(const FrictionLaw& law, double qd, double g) {
  return friction(formOf(law), qd, g);
}

/// The derivative `df/dqd` [N m s/rad] of a law at the velocity qd [rad/s] under the gravity torque
/// g [N m]. NaN for NaN.
///
/// A jump (Coulomb friction at rest) has none and counts as nothing.
inline double frictionSlope(const FrictionForm& law, double qd, double g) {
  using Number = Dual<double, 1>;
  if (std::isnan(qd)) return qd;
  return friction<Number>(law, Number::variable(qd, 0), g).derivative[0];
}

/// @copydoc frictionSlope(const FrictionForm&, double, double)
inline double frictionSlope(const FrictionLaw& law, double qd, double g) {
  return frictionSlope(formOf(law), qd, g);
}

/// The derivative `df/dg` [1] of a law at the velocity qd [rad/s] by the gravity torque g [N m]; zero
/// at g = 0, where |g| has none.
inline double frictionLoadSlope(const FrictionForm& law, double qd, double g) {
  using Number = Dual<double, 1>;
  if (law.fl == 0 || g == 0) return 0;
  return friction<Number>(law, qd, Number::variable(g, 0)).derivative[0];
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

/// Friction torques of laws: `f_j = friction(laws[j], qd_j, g_j)`; of all joints, where each has its own.
///
/// @param laws    n.
/// @param qd      n; rad/s (prismatic m/s).
/// @param g       n; gravity torques, N m (prismatic N); where no law depends on load, may be empty.
/// @param[out] f  n; N m (prismatic N).
void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd,
                    const Eigen::Ref<const Eigen::VectorXd>& g, Eigen::Ref<Eigen::VectorXd> f);

}  // namespace v2
}  // namespace chain_dynamics
