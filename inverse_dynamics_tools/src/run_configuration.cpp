// SPDX-License-Identifier: Apache-2.0
#include "run_configuration.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <chain_dynamics/located_yaml.hpp>
#include <inverse_dynamics_evaluation/package_share.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "description.hpp"
#include "errors.hpp"
#include "solver.hpp"
#include "solver_origin.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using Robot = evaluation::RunConfiguration;

/// A field of a Robot that holds a path; Object: its type in Python.
template <class Object>
struct PathOf {
  std::string Robot::*member;
};

/// Calls visit(name, member, meaning) for each field of a Robot.
template <class Visit>
void forEachField(const Visit& visit) {
  visit("name", &Robot::name, "a text");
  visit("description", &Robot::description, "a text, one line");
  visit("file", PathOf<FilePath>{&Robot::file}, "where it is from");
  visit("plugin", &Robot::plugin, "package/Class of the solver");
  visit("urdf", PathOf<MaybeFilePath>{&Robot::urdf}, "the path of a description");
  visit("model", PathOf<MaybeFilePath>{&Robot::model}, "the path of a model file");
  visit("root", &Robot::root, "a link; empty: the first");
  visit("tip", &Robot::tip, "a link; empty: the last");
  visit("gravity", &Robot::gravity, "three numbers, m/s^2, in the frame of the root link");
  visit("friction", &Robot::friction, "whether the solver's friction model counts");
  visit("topic", &Robot::topic, "the topic of recordings");
  visit("joints", &Robot::joints, "names in recordings, in the order of the chain");
  visit("effort", &Robot::effort, "what recorded efforts mean, one of EFFORT_CHOICES");
  visit("drive_gains", &Robot::drive_gains, "N m/A (prismatic N/A); none: the solver's");
  visit("accelerations", &Robot::accelerations, "a method, one of accelerations.METHODS");
  visit("cutoff", &Robot::cutoff, "Hz; None: chosen from the data");
  visit("parameters", &Robot::parameters,
        "others of the solver: a dictionary, dotted name to value");
  visit("columns", &Robot::columns, "of a table: KEY=PATTERN, ...");
  visit("scale", &Robot::scale, "of a table: KEY=NUMBER or KEY=UNIT, a text each");
  visit("sign", &Robot::sign, "of a table: 1 or -1 for each joint");
  visit("rate", &Robot::rate, "of a table without time: samples per second");
  visit("source", &Robot::source, "where description and values come from");
}

MaybeFilePath pathOf(const std::string& path) {
  if (path.empty()) return py::none();
  return py::module_::import("pathlib").attr("Path")(
      py::module_::import("os").attr("fsdecode")(py::bytes(path)));
}

ParameterDict dictOf(const evaluation::SolverParameters& parameters) {
  py::dict found;
  for (const auto& [name, value] : parameters) found[py::str(name)] = py::cast(value);
  return found;
}

// Values of fields as Python has them.
template <class Object>
Object valueOf(const Robot& robot, PathOf<Object> path) {
  return pathOf(robot.*path.member);
}
ParameterDict valueOf(const Robot& robot, evaluation::SolverParameters Robot::*member) {
  return dictOf(robot.*member);
}
NameTuple valueOf(const Robot& robot, std::vector<std::string> Robot::*member) {
  return tupleOf(robot.*member);
}
NumberTuple valueOf(const Robot& robot, std::vector<double> Robot::*member) {
  return py::tuple(py::cast(robot.*member));
}
Numbers3OrNone valueOf(const Robot& robot, std::optional<std::array<double, 3>> Robot::*member) {
  return robot.*member ? py::object(py::tuple(py::cast(*(robot.*member)))) : py::none();
}
template <class Value>
Value valueOf(const Robot& robot, Value Robot::*member) {
  return robot.*member;
}

// The same from Python. Throws py::cast_error: another type.
template <class Object>
void take(const py::handle& value, Robot& robot, PathOf<Object> path) {
  robot.*path.member = value.is_none() ? "" : value.cast<PathText>().bytes;
}
void take(const py::handle& value, Robot& robot, evaluation::SolverParameters Robot::*member) {
  (robot.*member).clear();
  for (const auto& [name, entry] : py::dict(py::reinterpret_borrow<py::object>(value))) {
    addParameter(name.cast<std::string>(), entry, robot.*member);
  }
}
template <class Value>
void take(const py::handle& value, Robot& robot, Value Robot::*member) {
  robot.*member = value.cast<Value>();
}

/// The robot with these fields, of a dictionary by name.
Robot withFields(Robot robot, const py::dict& fields) {
  std::size_t taken = 0;
  std::string names;
  forEachField([&](const char* name, auto member, const char* meaning) {
    names += (names.empty() ? "" : ", ") + std::string(name);
    if (!fields.contains(name)) return;
    ++taken;
    try {
      take(fields[name], robot, member);
    } catch (const py::cast_error&) {
      throwArgumentError("Robot: argument " + std::string(name) + ": expected " + meaning +
                         ", got " + std::string(py::repr(fields[name])));
    }
  });
  if (taken == fields.size()) return robot;
  throwArgumentError("Robot: expected arguments of the names " + names + ", got " +
                     std::string(py::str(", ").attr("join")(fields).cast<py::str>()));
}

py::dict fieldsOf(const Robot& robot) {
  py::dict fields;
  forEachField([&](const char* name, auto member, const char* /*meaning*/) {
    fields[name] = valueOf(robot, member);
  });
  return fields;
}

/// The robot with the changes that aren't None.
Robot withChanges(const Robot& robot, const py::kwargs& given) {
  py::dict stated;
  for (const auto& [name, value] : given) {
    if (!value.is_none()) stated[name] = value;
  }
  const Robot to = withFields({}, stated);
  evaluation::RunConfigurationChanges changes;  // those that change others too, or are added
  if (stated.contains("urdf")) changes.urdf = to.urdf;
  if (stated.contains("accelerations")) changes.accelerations = to.accelerations;
  changes.cutoff = to.cutoff;
  changes.parameters = to.parameters;
  stated.attr("pop")("parameters", py::none());
  return withFields(evaluation::withChanges(robot, changes), stated);
}

void bindRobot(py::module_& module) {
  py::class_<Robot> robot(module, "Robot",
                          "One run configuration. Empty text or None: not stated, so the solver's "
                          "own default.\n\n"
                          "Its fields can't be set: dataclasses.replace() makes a changed copy.");
  robot
      .def(py::init([](const std::string& name, const std::string& description,
                       const PathText& file, const std::string& plugin, const py::kwargs& others) {
             Robot made;
             made.name = name;
             made.description = description;
             made.file = file.bytes;
             made.plugin = plugin;
             return withFields(std::move(made), others);
           }),
           py::arg("name"), py::arg("description"), py::arg("file"), py::arg("plugin"),
           "The other fields by name.")
      .def_property_readonly(
          "files",
          [](const Robot& r) {
            return std::tuple(pathOf(r.file), pathOf(r.urdf), pathOf(r.model));
          },
          "What is read for this robot: run configuration, description, model.")
      .def(
          "__eq__", [](const Robot& a, const Robot& b) { return fieldsOf(a).equal(fieldsOf(b)); },
          py::is_operator())
      .def("__repr__",
           [](const Robot& r) {
             std::string text;
             for (const auto& [name, value] : fieldsOf(r)) {
               text += (text.empty() ? "" : ", ") + std::string(py::str(name)) + "=" +
                       std::string(py::repr(value));
             }
             return "Robot(" + text + ")";
           })
      .def(py::pickle(&fieldsOf, [](const py::dict& fields) { return withFields({}, fields); }));
  py::list names;
  forEachField([&](const char* name, auto member, const char* meaning) {
    robot.def_property_readonly(
        name, [member](const Robot& r) { return valueOf(r, member); }, meaning);
    names.append(name);
  });
  // For dataclasses.replace() and asdict(); made when asked for, as dataclasses takes 9 ms to import.
  robot.def_property_readonly_static("__dataclass_fields__", [names](const py::object&) {
    const auto dataclasses = py::module_::import("dataclasses");
    return dataclasses.attr("make_dataclass")("Robot", names).attr("__dataclass_fields__");
  });
}

evaluation::EffortOptions effortOptions(const Robot& robot, const SolverObject& solver,
                                        const std::optional<std::string>& option,
                                        const std::string& format) {
  evaluation::EffortOptions options = evaluation::effortOptions(robot, *solverOf(solver));
  options.option = option;
  options.format = format;
  return options;
}

}  // namespace

void bindRunConfiguration(py::module_& module) {
  bindRobot(module);
  module.def("robot_names", &evaluation::robotNames,
             "Names of the robots that the sourced workspaces bring.");
  module.def(
      "load_robot",
      [](const PathText& name_or_file) {
        return evaluation::readRunConfiguration(name_or_file.bytes);
      },
      py::arg("name_or_file"),
      "Run configuration by the name of one of robot_names(), or from a file.\n\n"
      "What ends in .yaml or .yml, or has a directory, is a file. Raises RobotError.");
  module.def(
      "with_changes", &withChanges, py::arg("robot"),
      "The run configuration with all fields replaced for which something is given, not None.\n\n"
      "A description that is given stands instead of a model file too, a method of accelerations\n"
      "without the cut-off of the configuration's own; parameters are given one by one.");
  module.def("recorded_names", &evaluation::recordedNames, py::arg("robot"), py::arg("joint_names"),
             "Names in a recording of the solver's joints, in the order of the chain.");
  module.def("effort_options", &effortOptions, py::arg("robot"), py::arg("solver"),
             py::arg("option") = py::none(), py::arg("format") = "",
             "What is stated of efforts: by a Robot, the user, the recording's format.");
  module.def(
      "solver_parameters",
      [](const chain_dynamics::LocatedMap& mapping) {
        return dictOf(evaluation::readSolverParameters(mapping));
      },
      py::arg("mapping"), "Parameters of a solver as YAML has them; dotted name to value.");
  module.def(
      "package_share",
      [](const std::string& package) -> FilePath {
        return pathOf(evaluation::packageShare(package));
      },
      py::arg("package"), "Directory `share/PACKAGE` of an installed package.");
  module.def(
      "resolved_path",
      [](const std::string& path, const PathText& directory) -> FilePath {
        return pathOf(evaluation::resolvedPath(path, directory.bytes));
      },
      py::arg("path"), py::arg("directory"),
      "File that a path in a configuration names; relative ones begin in the directory.");
}

}  // namespace inverse_dynamics_tools
