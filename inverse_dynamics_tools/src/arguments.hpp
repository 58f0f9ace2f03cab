// SPDX-License-Identifier: Apache-2.0
/// @file
/// Calls with arguments that a binding doesn't take: one line that names the argument.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

/// Replaces each public function, constructor and method of a module by one that does the same, but
/// raises `inverse_dynamics.errors.ArgumentError` where pybind11 raises its list of signatures.
///
/// Call it when everything is bound.
void explainRefusedArguments(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
