// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters of solvers, from and to Python.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_solver/parameters.hpp>
#include <map>
#include <string>

#include "annotations.hpp"

namespace inverse_dynamics_tools {

using ParameterValues = std::map<std::string, inverse_dynamics_solver::ParameterValue>;

/// Adds a Python value as a parameter; the entries of a dict as those of `name.KEY`.
///
/// @throws pybind11::error_already_set  ArgumentError: a type that no parameter has.
/// @throws InvalidParameterValueException  a parameter that is there already.
void addParameter(const std::string& name, const pybind11::handle& value, ParameterValues& all);

/// Parameters of a dictionary, dotted name to value. Throws as addParameter() does.
ParameterValues parametersOf(const pybind11::dict& values);

ParameterDict dictOf(const ParameterValues& parameters);

}  // namespace inverse_dynamics_tools
