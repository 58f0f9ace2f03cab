// SPDX-License-Identifier: Apache-2.0
/// @file
/// Classes `PayloadEstimator`, `PayloadEstimate`, `ResidualNoise` and function `residual_noise` of
/// the extension module.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindPayload(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
