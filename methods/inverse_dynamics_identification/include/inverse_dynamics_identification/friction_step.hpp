// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction with a smooth step, as it is fitted: what is linear in it, and what isn't.
///
///     f = fv qd + fo + (fc + fl |g(q)|) step + (fm + fs exp(-(qd / vs)^2)) (z + u step),
///     step = tanh((qd + shift) / width),
///
/// z and u of the motion up to the sample [chain_dynamics/friction_state.hpp], 0 and 1 without memory. In fv, fo, fc, fl, fs, fm
/// the law is linear; for width, shift, vs and distance a fit takes Gauss-Newton steps with the
/// derivatives as columns.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/dual.hpp>
#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>
#include <chain_dynamics/friction_state.hpp>

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Which terms there are beside viscous friction, offset and step.
enum class FrictionTerms {
  kStep,      ///< no other
  kLoad,      ///< fl
  kStribeck,  ///< fl and fs
  kMemory,    ///< fl, fs and fm, and the two last lag behind
};

/// What is fitted of a joint's spring, by the number of its columns.
enum class SpringTerms {
  kNone,
  kLinear,  ///< k q, whose rest is in the offset of friction
  kLever,   ///< a sin q + b cos q, of a spring that pulls a lever around
};

/// One law of friction.
using StepFriction = chain_dynamics::SmoothCoulomb;

/// Own columns of the fit: qdd, qd, 1, step, df/dshift, df/dlog(width), and with their terms
/// load step, Stribeck step, df/dlog(vs), z + u step, df/dlog(distance).
namespace own_column {
constexpr Eigen::Index kAcceleration = 0, kVelocity = 1, kOne = 2, kStep = 3, kShift = 4,
                       kWidth = 5, kLoad = 6, kStribeck = 7, kStribeckVelocity = 8, kMemory = 9,
                       kDistance = 10;
}  // namespace own_column

/// How many there are: 6, 7, 9 or 11.
Eigen::Index ownColumns(FrictionTerms terms);

/// Presliding up to a sample, with the derivative by log(distance).
using FittedPresliding = chain_dynamics::Presliding<chain_dynamics::Dual<double, 1>>;

/// Goes on by `by` [rad; prismatic m] with the distance of this law.
void move(FittedPresliding& memory, double by, const StepFriction& law);

/// The columns at one sample.
///
/// @param[out] row  ownColumns(terms) numbers.
void ownColumnsAt(const StepFriction& law, double qd, double qdd, double load,
                  const FittedPresliding& memory, Eigen::Ref<Eigen::VectorXd> row);

}  // namespace v2
}  // namespace inverse_dynamics_identification
