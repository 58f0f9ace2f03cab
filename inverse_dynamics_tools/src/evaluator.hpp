// SPDX-License-Identifier: Apache-2.0
/// @file
/// Function `evaluate` of the extension module, and what it gives: see
/// inverse_dynamics_evaluation/evaluator.hpp.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindEvaluator(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
