// SPDX-License-Identifier: Apache-2.0
#include "solver_origin.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

#include "errors.hpp"

namespace inverse_dynamics_tools {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

namespace {

/// A Python value as a parameter.
ids::ParameterValue parameterOf(const std::string& name, const py::handle& value) {
  // pybind11 would take the first alternative that it can convert to.
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return value.cast<std::int64_t>();
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::sequence>(value)) {
    const auto all = [&](auto is) {
      for (const py::handle entry : value)
        if (!is(entry)) return false;
      return true;
    };
    if (all([](py::handle e) { return py::isinstance<py::str>(e); })) {
      return value.cast<std::vector<std::string>>();
    }
    if (all([](py::handle e) { return py::isinstance<py::bool_>(e); })) {
      return value.cast<std::vector<bool>>();
    }
    if (all([](py::handle e) { return py::isinstance<py::int_>(e); })) {
      return value.cast<std::vector<std::int64_t>>();
    }
    if (all([](py::handle e) {
          return py::isinstance<py::float_>(e) || py::isinstance<py::int_>(e);
        })) {
      return value.cast<std::vector<double>>();
    }
  }
  const auto text = ids::errorText(
      "parameter '" + name + "'", "",
      "bool, int, float, str, a list of one of them, or a dict of parameters below this name",
      py::str(py::type::of(value).attr("__name__")));
  throwArgumentError(text);
}

}  // namespace

ParameterValues parametersOf(const Origin& origin) {
  auto all = origin.parameters;
  const auto give = [&all](const std::string& name, const ids::ParameterValue& value) {
    if (all.emplace(name, value).second) return;
    throw ids::InvalidParameterValueException(
        ids::errorText("Solver", "", "each parameter once",
                       "argument " + name + " and parameters['" + name + "']", "leave out one"));
  };
  if (!origin.friction || all.count("friction") == 0) give("friction", origin.friction);
  if (!origin.root.empty()) give("root", origin.root);
  if (!origin.tip.empty()) give("tip", origin.tip);
  if (!origin.attached.empty()) give("attached", origin.attached);
  if (origin.model) give("model", *origin.model);
  if (origin.gravity) {
    give("gravity", std::vector<double>(origin.gravity->begin(), origin.gravity->end()));
  }
  return all;
}

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

py::tuple argumentsOf(const Origin& origin) {
  py::dict parameters;
  for (const auto& [name, value] : origin.parameters) parameters[py::str(name)] = py::cast(value);
  return py::make_tuple(origin.plugin, origin.urdf, origin.root, origin.tip, origin.gravity,
                        origin.friction, origin.attached, origin.model, parameters);
}

}  // namespace inverse_dynamics_tools
