// SPDX-License-Identifier: Apache-2.0
/// @file
/// What only some solvers compute, on numpy arrays: the methods of Solver of the same names.
#pragma once

#include <pybind11/numpy.h>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>

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
pybind11::object tipPose(const NamedSolver& of, const pybind11::object& q);
pybind11::object tipJacobian(const NamedSolver& of, const pybind11::object& q,
                             const pybind11::object& out);
pybind11::object tipJacobianDerivative(const NamedSolver& of, const pybind11::object& q,
                                       const pybind11::object& qd, const pybind11::object& out);
pybind11::object externalTorques(const NamedSolver& of, const pybind11::object& q,
                                 const pybind11::object& wrench, const std::string& frame,
                                 const pybind11::object& out);
pybind11::object torquesWithWrench(const NamedSolver& of, const pybind11::object& q,
                                   const pybind11::object& qd, const pybind11::object& qdd,
                                   const pybind11::object& wrench, const std::string& frame,
                                   const pybind11::object& out);
pybind11::object coriolisMatrix(const NamedSolver& of, const pybind11::object& q,
                                const pybind11::object& qd, const pybind11::object& out);
pybind11::object kineticEnergy(const NamedSolver& of, const pybind11::object& q,
                               const pybind11::object& qd);
pybind11::object potentialEnergy(const NamedSolver& of, const pybind11::object& q);
pybind11::object torqueDerivatives(const NamedSolver& of, const pybind11::object& q,
                                   const pybind11::object& qd, const pybind11::object& qdd);
pybind11::object regressor(const NamedSolver& of, const pybind11::object& q,
                           const pybind11::object& qd, const pybind11::object& qdd,
                           const pybind11::object& out);
pybind11::object accelerations(const NamedSolver& of, const pybind11::object& q,
                               const pybind11::object& qd, const pybind11::object& tau,
                               const pybind11::object& out);
/// @}

}  // namespace inverse_dynamics_tools
