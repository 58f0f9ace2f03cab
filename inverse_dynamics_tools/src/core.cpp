// SPDX-License-Identifier: Apache-2.0
/// @file
/// The extension module `inverse_dynamics._core`: solvers by name, accelerations, metrics and
/// control laws, on numpy arrays.
///
/// A batch is an (N, n) array, one state a row. Row after row in memory it is, byte for byte, the
/// n x N matrix of Eigen with one state a column: nothing is copied. Solvers copy another layout (a
/// transposed or strided array) a tile of states at a time, and another type as a whole; the other
/// functions copy either once on the way in. All computing releases the GIL.

#include <pybind11/pybind11.h>

#include "accelerations.hpp"
#include "control.hpp"
#include "errors.hpp"
#include "metrics.hpp"
#include "solver.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Solvers, accelerations, metrics and control laws in C++.";
  inverse_dynamics_tools::bindErrors();
  inverse_dynamics_tools::bindSolver(module);
  inverse_dynamics_tools::bindAccelerations(module);
  inverse_dynamics_tools::bindMetrics(module);
  inverse_dynamics_tools::bindControl(module);
}
