// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recorded joint states in Python.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_evaluation/joint_log.hpp>
#include <string>

namespace inverse_dynamics_tools {

/// `header`, `receive`, or else whichever there is.
inverse_dynamics_evaluation::Clock clockOf(const std::string& clock);

void bindJointLog(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
