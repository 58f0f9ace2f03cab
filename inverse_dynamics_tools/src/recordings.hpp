// SPDX-License-Identifier: Apache-2.0
/// @file
/// rosbag2 recordings, for Python.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <string>

#include "initialized.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::SampleTable)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::Recording)

namespace inverse_dynamics_tools {

/// `header`, `receive`, or else whichever there is.
inverse_dynamics_evaluation::Clock clockOf(const std::string& clock);

/// Declares `Recording`, `Messages`, `JointStates`, `SampleTable` and `JointStateWriter`.
void bindRecordings(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
