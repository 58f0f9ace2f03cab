// SPDX-License-Identifier: Apache-2.0
/// @file
/// What only some solvers compute, on numpy arrays: the methods of Solver of the same names.
#pragma once

#include <pybind11/numpy.h>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>

#include "annotations.hpp"

namespace inverse_dynamics_tools {

/// A solver, and the plugin that errors name.
struct NamedSolver {
  const inverse_dynamics_solver::InverseDynamicsSolver& solver;
  const std::string& plugin;
};

/// @name Quantities
/// Arguments as in SolverCall; a wrench (6,) for all states or (N, 6), force first.
///
/// @throws Exception  naming the solvers that have it, where this one hasn't.
/// @{
TwoFloats tipPose(const NamedSolver& of, const ArrayLike& q);
Floats tipJacobian(const NamedSolver& of, const ArrayLike& q, const MaybeFloats& out);
Floats tipJacobianDerivative(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                             const MaybeFloats& out);
Floats externalTorques(const NamedSolver& of, const ArrayLike& q, const ArrayLike& wrench,
                       const std::string& frame, const MaybeFloats& out);
Floats torquesWithWrench(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                         const ArrayLike& qdd, const ArrayLike& wrench, const std::string& frame,
                         const MaybeFloats& out);
Floats coriolisMatrix(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                      const MaybeFloats& out);
FloatOrFloats kineticEnergy(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd);
FloatOrFloats potentialEnergy(const NamedSolver& of, const ArrayLike& q);
ThreeFloats torqueDerivatives(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                              const ArrayLike& qdd);
Floats regressor(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                 const ArrayLike& qdd, const MaybeFloats& out);
Floats accelerations(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                     const ArrayLike& tau, const MaybeFloats& out);
/// @}

}  // namespace inverse_dynamics_tools
