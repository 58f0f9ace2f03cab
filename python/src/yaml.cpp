// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <chain_dynamics/located_yaml.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "description.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
using chain_dynamics::LocatedMap;
using chain_dynamics::LocatedValue;

/// Raises a Python exception of that class.
LocatedValue::Throw raising(const py::type& error) {
  return [error](const std::string& text) {
    PyErr_SetObject(error.ptr(), textOf(text).ptr());
    throw py::error_already_set();
  };
}

}  // namespace

void bindYaml(py::module_& module) {
  py::class_<LocatedMap> map(module, "YamlMap", "Keys with values, and which have been asked for.");
  py::class_<LocatedValue>(module, "YamlValue", "A value of a YAML file and where it stands.")
      .def_property_readonly("where", &LocatedValue::where, "`file:line: key`, as errors begin.")
      .def_property_readonly("is_list", &LocatedValue::isList, "Whether it is a list.")
      .def(
          "fail",
          [](const LocatedValue& value, const std::string& expected, const std::string& remedy) {
            value.fail(expected, remedy);
          },
          "expected"_a, "remedy"_a = "", "Raise the error that says what was expected here.")
      .def("scalar", &LocatedValue::scalar, "A text, a finite number, an integer, true or false.")
      .def("text", &LocatedValue::text, "one_of"_a = std::vector<std::string>(),
           "A text; one of these, if any are given.")
      .def("number", &LocatedValue::number, "A finite number.")
      .def("integer", &LocatedValue::integer, "An integer of 64 bits.")
      .def("truth", &LocatedValue::truth, "True or false.")
      .def("entries", &LocatedValue::entries, "length"_a = py::none(),
           "A list; of this length, if one is given.")
      .def("mapping", &LocatedValue::map, "Keys with values.");
  map.def("expect", &LocatedMap::expect, "keys"_a,
          "Raise an error that names all of these keys that are missing.")
      .def("required", &LocatedMap::required, "key"_a, "The value of a key that must be there.")
      .def("optional", &LocatedMap::optional, "key"_a,
           "The value of a key, or None if it is absent or null.")
      .def("reject_others", &LocatedMap::rejectOthers,
           "Raise the error for a key that hasn't been read.");
  module.def(
      "read_yaml",
      [](const PathText& path, const py::type& error) {
        return LocatedValue::ofFile(path.bytes, raising(error));
      },
      "path"_a, "error"_a,
      "The value that a YAML file is. error: what is raised, now and by the value.");
  module.def(
      "parse_yaml",
      [](const py::bytes& text, const std::string& file, const py::type& error) {
        return LocatedValue::ofText(text, file, raising(error));
      },
      "text"_a, "file"_a, "error"_a, "The value that a text of YAML is.");
}

}  // namespace inverse_dynamics_tools
