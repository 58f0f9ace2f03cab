// SPDX-License-Identifier: Apache-2.0
/// @file
/// Run configurations, strict YAML, and where installed packages keep their files.
#pragma once

#include <pybind11/pybind11.h>

#include <chain_dynamics/located_yaml.hpp>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>

#include "initialized.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(chain_dynamics::LocatedMap)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortOptions)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::RunConfiguration)

namespace inverse_dynamics_tools {

void bindRunConfiguration(pybind11::module_& module);
void bindYaml(pybind11::module_& module);

}  // namespace inverse_dynamics_tools
