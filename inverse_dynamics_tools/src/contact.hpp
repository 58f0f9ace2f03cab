// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators of external torques and what finds contacts, of the package inverse_dynamics_control.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

/// After bindControl().
void bindContact(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
