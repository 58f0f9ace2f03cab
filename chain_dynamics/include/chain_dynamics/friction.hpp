// SPDX-License-Identifier: Apache-2.0

/// @file
/// Joint friction: what a motor must add, at a given joint velocity, to what rigid bodies ask for.
///
///     FrictionLaw law = CenteredSigmoid{0.54615, 5.1181, 0.039533};  // amplitude, slope, shift
///     double f = friction(law, 0.3);                                 // N m at 0.3 rad/s
///     frictionVector(laws, qd, f_vector);                            // one law per joint
///
/// Sign: f enters `tau = H qdd + C qd + f + g`, so it is positive for positive velocities where
/// friction brakes.
///
/// The smooth laws are made of one step, the logistic function
///
///     sigmoid(x) = 1 / (1 + exp(-x)),      0 for x -> -inf, 1/2 at x = 0, 1 for x -> +inf,
///
/// which stands for the jump of Coulomb friction: `alpha` says how steep it is [s/rad], a shift in
/// velocity where it is. Identified slopes reach hundreds of s/rad, so exp(-alpha (qd + nu))
/// overflows within the velocities of a robot. It is therefore computed with the exponent that
/// can't be positive: for x < 0 as exp(x) / (1 + exp(x)).
///
/// A new law is a struct with its figures, functions `friction(law, qd)`, `frictionSlope(law, qd)`
/// and `scaled(law, factor)`, and one more name in FrictionLaw.

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <variant>
#include <vector>

namespace chain_dynamics {
inline namespace v2 {

/// Coulomb friction with a viscous part and an offset: `f = fv qd + fc sign(qd) + fo`.
struct ViscousCoulombOffset {
  double fv = 0;  ///< viscous coefficient [N m s/rad] (prismatic: N s/m)
  double fc = 0;  ///< Coulomb friction [N m] (prismatic: N); nothing at qd = 0
  double fo = 0;  ///< offset [N m] (prismatic: N), there at rest too
};

/// Coulomb friction as a smooth step beside a viscous part and an offset:
/// `f = fv qd + fo + fc / (1 + exp(-alpha (qd + nu)))`.
///
/// Not zero at rest: the step goes from fo to fo + fc. [Petrone et al. 2025,
/// doi 10.1109/TII.2025.3534415]
struct ViscousOffsetSigmoid {
  double fv = 0;     ///< viscous coefficient [N m s/rad]
  double fo = 0;     ///< offset [N m]
  double fc = 0;     ///< height of the step [N m], of either sign
  double alpha = 0;  ///< steepness [s/rad], of either sign
  double nu = 0;     ///< shift [rad/s]: the step is at qd = -nu
};

/// A smooth step that is zero at rest: `f = A / (1 + exp(-alpha (qd + delta))) - A / (1 +
/// exp(-alpha delta))`.
///
/// [Gaz et al. 2019, doi 10.1109/LRA.2019.2931248]
struct CenteredSigmoid {
  double A = 0;      ///< height of the step [N m]
  double alpha = 0;  ///< steepness [s/rad]
  double delta = 0;  ///< shift [rad/s]: the step is at qd = -delta
};

/// Friction of one joint: one of the named laws. ViscousCoulombOffset{} is no friction at all.
using FrictionLaw = std::variant<ViscousCoulombOffset, ViscousOffsetSigmoid, CenteredSigmoid>;

/// The logistic function `1 / (1 + exp(-x))`, without overflow for any x; NaN gives NaN.
inline double sigmoid(double x) {
  const double e = std::exp(-std::abs(x));  // never above one
  return (x < 0 ? e : 1.0) / (1.0 + e);
}

/// Friction torque [N m] of a law at the velocity qd [rad/s]. NaN for NaN, and for no finite
/// velocity.
///
/// Real time: no allocation, lock, exception or system call. Threads: safe.
inline double friction(const ViscousCoulombOffset& law, double qd) {
  const double sign = qd > 0 ? 1.0 : (qd < 0 ? -1.0 : 0.0);
  return law.fv * qd + law.fc * sign + law.fo;  // NaN stays: 0 * NaN is NaN
}

/// @copydoc friction(const ViscousCoulombOffset&, double)
inline double friction(const ViscousOffsetSigmoid& law, double qd) {
  return law.fv * qd + law.fo + law.fc * sigmoid(law.alpha * (qd + law.nu));
}

/// @copydoc friction(const ViscousCoulombOffset&, double)
inline double friction(const CenteredSigmoid& law, double qd) {
  return law.A * (sigmoid(law.alpha * (qd + law.delta)) - sigmoid(law.alpha * law.delta));
}

/// @copydoc friction(const ViscousCoulombOffset&, double)
inline double friction(const FrictionLaw& law, double qd) {
  return std::visit([qd](const auto& named) { return friction(named, qd); }, law);
}

/// The derivative `df/dqd` [N m s/rad] of a law at the velocity qd [rad/s]. NaN for NaN.
///
/// A jump (Coulomb friction at rest) has none and counts as nothing.
/// Real time: no allocation, lock, exception or system call. Threads: safe.
inline double frictionSlope(const ViscousCoulombOffset& law, double qd) {
  return std::isnan(qd) ? qd : law.fv;
}

/// @copydoc frictionSlope(const ViscousCoulombOffset&, double)
inline double frictionSlope(const ViscousOffsetSigmoid& law, double qd) {
  const double x = law.alpha * (qd + law.nu);
  return law.fv + law.fc * law.alpha * sigmoid(x) * sigmoid(-x);
}

/// @copydoc frictionSlope(const ViscousCoulombOffset&, double)
inline double frictionSlope(const CenteredSigmoid& law, double qd) {
  const double x = law.alpha * (qd + law.delta);
  return law.A * law.alpha * sigmoid(x) * sigmoid(-x);
}

/// @copydoc frictionSlope(const ViscousCoulombOffset&, double)
inline double frictionSlope(const FrictionLaw& law, double qd) {
  return std::visit([qd](const auto& named) { return frictionSlope(named, qd); }, law);
}

/// The same law with its torque multiplied by a factor: from motor currents [A] to torques by a
/// drive gain [N m/A].
inline FrictionLaw scaled(const ViscousCoulombOffset& law, double factor) {
  return ViscousCoulombOffset{factor * law.fv, factor * law.fc, factor * law.fo};
}

/// @copydoc scaled(const ViscousCoulombOffset&, double)
inline FrictionLaw scaled(const ViscousOffsetSigmoid& law, double factor) {
  return ViscousOffsetSigmoid{factor * law.fv, factor * law.fo, factor * law.fc, law.alpha, law.nu};
}

/// @copydoc scaled(const ViscousCoulombOffset&, double)
inline FrictionLaw scaled(const CenteredSigmoid& law, double factor) {
  return CenteredSigmoid{factor * law.A, law.alpha, law.delta};
}

/// @copydoc scaled(const ViscousCoulombOffset&, double)
inline FrictionLaw scaled(const FrictionLaw& law, double factor) {
  return std::visit([factor](const auto& named) { return scaled(named, factor); }, law);
}

/// Friction torques of all joints: `f_j = friction(laws[j], qd_j)`.
///
/// @param laws    one per joint.
/// @param qd      n; rad/s (prismatic m/s).
/// @param[out] f  n; N m (prismatic N).
/// Real time: no allocation, lock, exception or system call. Threads: safe.
void frictionVector(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd, Eigen::Ref<Eigen::VectorXd> f);

/// Their derivatives: `slope_j = frictionSlope(laws[j], qd_j)`, the diagonal of `df/dqd`.
///
/// @param laws        one per joint.
/// @param qd          n; rad/s (prismatic m/s).
/// @param[out] slope  n; N m s/rad (prismatic N s/m).
/// Real time: no allocation, lock, exception or system call. Threads: safe.
void frictionSlopes(const std::vector<FrictionLaw>& laws,
                    const Eigen::Ref<const Eigen::VectorXd>& qd, Eigen::Ref<Eigen::VectorXd> slope);

}  // namespace v2
}  // namespace chain_dynamics
