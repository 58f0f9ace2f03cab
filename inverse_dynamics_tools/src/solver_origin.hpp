// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a solver was made from, as Python gives it and pickle keeps it.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <inverse_dynamics_solver/parameters.hpp>
#include <map>
#include <optional>
#include <string>

namespace inverse_dynamics_tools {

using ParameterValues = std::map<std::string, inverse_dynamics_solver::ParameterValue>;

/// What a solver was made from: enough to make it again elsewhere (pickle).
struct Origin {
  std::string plugin, urdf, root, tip;
  std::optional<std::array<double, 3>> gravity;
  bool friction = true;
  std::string attached;
  std::optional<std::string> model;
  ParameterValues parameters;
};

/// All of it as parameters of `initialize`; what isn't given is left to the solver.
ParameterValues parametersOf(const Origin& origin);

/// Adds a Python value as a parameter; the entries of a dict as those of `name.KEY`.
///
/// @throws pybind11::error_already_set  ArgumentError: a type that no parameter has.
/// @throws InvalidParameterValueException  a parameter that is there already.
void addParameter(const std::string& name, const pybind11::handle& value, ParameterValues& all);

/// The arguments that make the solver again, in the order of its constructor.
pybind11::tuple argumentsOf(const Origin& origin);

}  // namespace inverse_dynamics_tools
