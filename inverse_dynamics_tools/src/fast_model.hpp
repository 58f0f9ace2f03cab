// SPDX-License-Identifier: Apache-2.0
/// @file
/// Class `FastModel` of the extension module: what the engine computes and no solver offers.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindFastModel(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
