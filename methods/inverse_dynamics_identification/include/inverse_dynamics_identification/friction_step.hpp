// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction with a smooth step, as it is fitted: what is linear in it, and what isn't.
///
///     f = fv qd + fo + (fc + fl |g(q)| + fs exp(-(qd / vs)^2)) tanh((qd + shift) / width)
///
/// In fv, fo, fc, fl, fs the law is linear; for width, shift and vs a fit takes Gauss-Newton steps with
/// the derivatives as columns.

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Which terms there are beside viscous friction, offset and step.
enum class FrictionTerms {
  kStep,      ///< no other
  kLoad,      ///< fl
  kStribeck,  ///< fl and fs
};

/// The law of one joint.
using StepFriction = chain_dynamics::SmoothCoulomb;

/// Own columns of the fit: qdd, qd, 1, step, df/dshift, df/dlog(width), and with their terms
/// load step, Stribeck step, df/dlog(vs).
namespace own_column {
constexpr Eigen::Index kAcceleration = 0, kVelocity = 1, kOne = 2, kStep = 3, kShift = 4,
                       kWidth = 5, kLoad = 6, kStribeck = 7, kStribeckVelocity = 8;
}  // namespace own_column

/// How many there are: 6, 7 or 9.
Eigen::Index ownColumns(FrictionTerms terms);

/// The columns at one sample.
///
/// @param[out] row  ownColumns(terms) numbers.
void ownColumnsAt(const StepFriction& law, double qd, double qdd, double load,
                  Eigen::Ref<Eigen::VectorXd> row);

}  // namespace v2
}  // namespace inverse_dynamics_identification
