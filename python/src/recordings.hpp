// SPDX-License-Identifier: Apache-2.0
/// @file
/// Helpers for reading recordings.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <string>

namespace inverse_dynamics_tools {

/// `header`, `receive`, or else whichever there is.
inverse_dynamics_evaluation::Clock clockOf(const std::string& clock);

/// Calls a function of Python, which must outlive it, with the share that is done; Ctrl-C is raised.
inline auto telling(const pybind11::function& progress) {
  return [&progress](double share) {
    const pybind11::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
    progress(share);
  };
}

}  // namespace inverse_dynamics_tools
