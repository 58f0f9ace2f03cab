// SPDX-License-Identifier: Apache-2.0
/// @file
/// Control laws, for the extension module.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindControl(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
