// SPDX-License-Identifier: Apache-2.0
/// @file
/// Accelerations of recorded motions, and what they rest on, for the extension module.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindAccelerations(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
