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

/// What a solver was made from: enough to make it again elsewhere (pickle).
struct Origin {
  std::string plugin, urdf, root, tip;
  std::optional<std::array<double, 3>> gravity;
  bool friction = true;
  std::string attached;
  std::optional<std::string> model;
  std::map<std::string, inverse_dynamics_solver::ParameterValue> parameters;
};

/// All of it as parameters of `initialize`; what isn't given is left to the solver.
std::map<std::string, inverse_dynamics_solver::ParameterValue> parametersOf(const Origin& origin);

/// A Python value as a parameter.
///
/// @throws pybind11::type_error  a type that no parameter has.
inverse_dynamics_solver::ParameterValue parameterOf(const std::string& name,
                                                    const pybind11::handle& value);

/// The arguments that make the solver again, in the order of its constructor.
pybind11::tuple argumentsOf(const Origin& origin);

}  // namespace inverse_dynamics_tools
