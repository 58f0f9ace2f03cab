// SPDX-License-Identifier: Apache-2.0
/// @file
/// Classes `ArmFitter` and `ArmFit` of the extension module: fits of the package
/// inverse_dynamics_identification.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindIdentification(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
