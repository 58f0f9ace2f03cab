// SPDX-License-Identifier: Apache-2.0
#include "parameters.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <string>
#include <vector>

#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

template <class... Types>
bool allAre(const py::handle& sequence) {
  for (const py::handle entry : sequence) {
    if (!(py::isinstance<Types>(entry) || ...)) return false;
  }
  return true;
}

/// A Python value as a parameter; pybind11 would take the first alternative that it can convert to.
ids::ParameterValue parameterOf(const std::string& name, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return value.cast<std::int64_t>();
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::sequence>(value)) {
    if (allAre<py::str>(value)) return value.cast<std::vector<std::string>>();
    if (allAre<py::bool_>(value)) return value.cast<std::vector<bool>>();
    if (allAre<py::int_>(value)) return value.cast<std::vector<std::int64_t>>();
    if (allAre<py::float_, py::int_>(value)) return value.cast<std::vector<double>>();
  }
  throwError(
      "ArgumentError",
      ids::errorText(
          "parameter '" + name + "'", "",
          "bool, int, float, str, a list of one of them, or a dict of parameters below this name",
          py::str(py::type::of(value).attr("__name__"))));
}

}  // namespace

void addParameter(const std::string& name, const py::handle& value, ParameterValues& all) {
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, entry] : py::reinterpret_borrow<py::dict>(value)) {
      addParameter(name + "." + std::string(py::str(key)), entry, all);
    }
  } else if (!all.emplace(name, parameterOf(name, value)).second) {
    throw ids::InvalidParameterValueException(
        ids::errorText("parameter '" + name + "'", "", "each parameter once", "it twice"));
  }
}

ParameterValues parametersOf(const py::dict& values) {
  ParameterValues all;
  for (const auto& [name, value] : values) addParameter(name.cast<std::string>(), value, all);
  return all;
}

ParameterDict dictOf(const ParameterValues& parameters) {
  py::dict found;
  for (const auto& [name, value] : parameters) found[py::str(name)] = py::cast(value);
  return found;
}

}  // namespace inverse_dynamics_tools
