// SPDX-License-Identifier: Apache-2.0
/// @file
/// From decoded messages to samples, for Python.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

/// Declares `RecordedJoints` and `JointLogBuilder`.
void bindJointLog(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
