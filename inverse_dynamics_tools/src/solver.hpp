// SPDX-License-Identifier: Apache-2.0
/// @file
/// Class `Solver` and function `available_solvers` of the extension module.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>

namespace inverse_dynamics_tools {

void bindSolver(pybind11::module_& module);

/// The solver inside an object of class Solver; it outlives the object if need be.
///
/// @throws pybind11::type_error  another class.
std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solverOf(
    const pybind11::handle& object);

}  // namespace inverse_dynamics_tools
