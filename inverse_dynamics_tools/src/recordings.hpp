// SPDX-License-Identifier: Apache-2.0
/// @file
/// rosbag2 recordings, for Python.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

/// Declares `Recording`, `Connection`, `Messages`, `JointStates` and `JointStateWriter`.
void bindRecordings(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
