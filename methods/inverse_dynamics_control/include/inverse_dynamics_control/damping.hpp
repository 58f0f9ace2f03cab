// SPDX-License-Identifier: Apache-2.0
/// @file
/// Damping that suits an arm, from one number.
///
///     options.damping = dampingFor(*solver, q_home, 5.0, period);   // 5 1/s
///
/// The same damping in all joints would be little for a shoulder and far too much for a wrist: the
/// inertias of a UR10's joints lie four orders of magnitude apart, and damping that is sampled with
/// a period T is unstable where it is beyond 2 inertia / T.
#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Damping in proportion to the inertia of each joint: `D_j = rate H_jj(q)`.
///
/// Motions decay with the eigenvalues of H^-1 D: the slowest at least with rate / n, one joint
/// alone (the others held) with `rate`, and opposite motions of joints whose axes nearly coincide
/// much faster. In other postures H is another: see that the arm is damped and steady there too.
///
/// @param q       n; rad (prismatic m); finite.
/// @param rate    1/s; finite, > 0.
/// @param period  s; of the control loop, > 0.
/// @return n; N m s/rad (prismatic N s/m).
/// Throws inverse_dynamics_solver::InvalidParameterValueException: a solver whose
/// inertiaIsPhysical() is false, a number out of its range, a decay that is faster than 1 / period
/// (half of what is stable). UninitializedException, SizeMismatchException: as
/// solver.getInertiaMatrix(q). Allocates.
chain_dynamics::OwnedVector dampingFor(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                                       const inverse_dynamics_solver::ConstVectorRef& q,
                                       double rate, double period);

}  // namespace v2
}  // namespace inverse_dynamics_control
