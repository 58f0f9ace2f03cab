// SPDX-License-Identifier: Apache-2.0
/// @file
/// Run configurations, strict YAML, and where installed packages keep their files.
#pragma once

#include <pybind11/pybind11.h>

namespace inverse_dynamics_tools {

void bindRunConfiguration(pybind11::module_& module);
void bindYaml(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
