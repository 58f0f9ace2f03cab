// SPDX-License-Identifier: Apache-2.0
/// @file
/// Class `Solver` and function `available_solvers` of the extension module.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindSolver(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
