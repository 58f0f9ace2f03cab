// SPDX-License-Identifier: Apache-2.0
/// @file
/// Function `metrics` and class `JointMetrics` of the extension module.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindMetrics(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
