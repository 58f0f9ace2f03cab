// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <chain_dynamics/located_yaml.hpp>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/package_share.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "annotations.hpp"
#include "bindings.hpp"
#include "description.hpp"
#include "fields.hpp"
#include "parameters.hpp"
#include "tips.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace evaluation = inverse_dynamics_evaluation;
using Robot = evaluation::RunConfiguration;

py::object pathOf(const std::string& path) {
  if (path.empty()) return py::none();
  return py::module_::import("pathlib").attr("Path")(textOf(path));
}

/// A field that holds a path; empty: None. Got: its type in Python.
template <class Got = MaybeFilePath>
auto pathField(const char* name, std::string Robot::*member, const char* doc) {
  using MaybePath = std::optional<PathText>;
  return Field<Robot, Got, MaybePath>(
      name, [member](const Robot& r) { return Got(pathOf(r.*member)); },
      [member](Robot& r, const MaybePath& path) { r.*member = path ? path->bytes : ""; }, doc);
}

void bindRobot(py::module_& module) {
  bindRecord<4>(
      module, "Robot",
      R"(One run configuration. Empty text or None: not stated, so the solver's own default.

Its fields can't be set: dataclasses.replace() makes a changed copy.

Examples
--------
>>> from dataclasses import replace
>>> from inverse_dynamics import load_robot
>>> robot = replace(load_robot("ur10_simulated"), gravity=(0.0, 0.0, -1.62))
>>> robot.solver()
<Solver kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL: 6 joints, shoulder_pan_joint to wrist_3_joint>)",
      Field{"name", &Robot::name, "of one word"},
      Field{"description", &Robot::description, "one line"},
      pathField<FilePath>("file", &Robot::file, "where it is from"),
      Field{"plugin", &Robot::plugin, "package/Class of the solver"},
      pathField("urdf", &Robot::urdf, "the path of a description"),
      pathField("model", &Robot::model, "the path of a model file"),
      Field{"root", &Robot::root, "a link; empty: the first"},
      Field<Robot, std::string, Tips>(
          "tip", [](const Robot& r) { return r.tip; },
          [](Robot& r, const Tips& tips) { r.tip = textOf(tips); },
          "a link, several with commas or as a list, or *: all leaves; empty: the last"),
      Field{"gravity", &Robot::gravity, "three numbers, m/s^2, in the frame of the root link"},
      Field{"friction", &Robot::friction, "whether the solver's friction model counts"},
      Field{"topic", &Robot::topic, "the topic of recordings"},
      Field{"joints", &Robot::joints, "names in recordings, in the order of the chain"},
      Field{"effort", &Robot::effort, "what recorded efforts mean, one of EFFORT_CHOICES"},
      Field{"drive_gains", &Robot::drive_gains, "N m/A (prismatic N/A); none: the solver's"},
      Field{"accelerations", &Robot::accelerations, "a method, one of accelerations.METHODS"},
      Field{"cutoff", &Robot::cutoff, "Hz; None: chosen from the data"},
      Field<Robot, ParameterDict, ParameterDict>(
          "parameters", [](const Robot& r) { return dictOf(r.parameters); },
          [](Robot& r, const ParameterDict& values) { r.parameters = parametersOf(values); },
          "others of the solver: dotted name to value"),
      Field{"columns", &Robot::columns, "of a table: KEY=PATTERN, ..."},
      Field{"scale", &Robot::scale, "of a table: KEY=NUMBER or KEY=UNIT, a text each"},
      Field{"sign", &Robot::sign, "of a table: 1 or -1 for each joint"},
      Field{"rate", &Robot::rate, "of a table without time: samples per second"},
      Field{"gears", &Robot::gears, "of motors that are recorded: ratios, or rows of a matrix"},
      Field{
          "friction_at", &Robot::friction_at,
          "of a fit: places beside the joints with friction, their velocity by factors of joints"},
      Field{"fit_springs", &Robot::fit_springs, "of a fit: linear or lever, by joint"},
      Field{"source", &Robot::source, "where description and values come from"})
      .def_property_readonly(
          "files",
          [](const Robot& r) {
            return std::tuple<FilePath, MaybeFilePath, MaybeFilePath>(
                pathOf(r.file), pathOf(r.urdf), pathOf(r.model));
          },
          "What is read for this robot: run configuration, description, model.")
      .def(
          "solver",
          [](const py::object& robot) -> SolverObject {
            return py::module_::import("inverse_dynamics._core").attr("Solver")(robot);
          },
          "The solver that the run configuration names.\n\nReturns\n-------\nSolver");
}

/// The robot with the changes that aren't None.
Robot withChanges(const Robot& robot, const py::kwargs& given) {
  py::dict stated;
  for (const auto& [name, value] : given) {
    if (!value.is_none()) stated[name] = value;
  }
  const auto to = py::module_::import("dataclasses").attr("replace")(robot, **stated).cast<Robot>();
  Robot changed = to;  // but for what changes with it, or is added
  if (stated.contains("urdf")) replaceDescription(changed, to.urdf);
  if (stated.contains("model")) changed.model = to.model;
  if (stated.contains("accelerations") || stated.contains("cutoff")) {
    const auto cutoff = stated.contains("cutoff") ? to.cutoff : std::nullopt;
    replaceAccelerations(changed, to.accelerations, cutoff);
  }
  changed.parameters.insert(robot.parameters.begin(), robot.parameters.end());
  return changed;
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
             R"(Names of the robots that the sourced workspaces bring.

Returns
-------
list of str

Examples
--------
>>> from inverse_dynamics import robot_names
>>> "ur10_real" in robot_names()
True)");
  module.def(
      "load_robot",
      [](const PathText& name_or_file) {
        return evaluation::readRunConfiguration(name_or_file.bytes);
      },
      "name_or_file"_a,
      R"(Run configuration by name or from a file.

Parameters
----------
name_or_file : str or path
    One of robot_names(); what ends in .yaml or .yml, or has a directory, is a file. One that ends
    in .urdf: robot_of_description().

Returns
-------
Robot

Raises
------
RobotError
    It isn't there, or isn't right.

Examples
--------
>>> from inverse_dynamics import load_robot
>>> load_robot("ur10_real").joints[:2]
('shoulder_pan_joint', 'shoulder_lift_joint'))");
  module.def(
      "robot_of_description",
      [](const PathText& urdf) { return evaluation::robotOfDescription(urdf.bytes); }, "urdf"_a,
      "A robot of which only the description is known: rigid bodies without friction.\n\n"
      "Its name is the file's; what recorded efforts mean is found from the data.");
  module.def(
      "with_changes", &withChanges, "robot"_a,
      "The run configuration with all fields replaced for which something is given, not None.\n\n"
      "A description that is given stands instead of a model file too, a method of accelerations\n"
      "without the cut-off of the configuration's own; parameters are given one by one.");
  module.def("recorded_names", &evaluation::recordedNames, "robot"_a, "joint_names"_a,
             "Names in a recording of the solver's joints, in the order of the chain.");
  module.def("effort_options", &effortOptions, "robot"_a, "solver"_a, "option"_a = py::none(),
             "format"_a = "",
             "What is stated of efforts: by a Robot, the user, the recording's format.");
  module.def(
      "solver_parameters",
      [](const chain_dynamics::LocatedMap& mapping) {
        return dictOf(evaluation::readSolverParameters(mapping));
      },
      "mapping"_a, "Parameters of a solver as YAML has them; dotted name to value.");
  module.def(
      "package_share",
      [](const std::string& package) -> FilePath {
        return pathOf(evaluation::packageShare(package));
      },
      "package"_a, "Directory `share/PACKAGE` of an installed package.");
  module.def(
      "resolved_path",
      [](const std::string& path, const PathText& directory) -> FilePath {
        return pathOf(evaluation::resolvedPath(path, directory.bytes));
      },
      "path"_a, "directory"_a,
      "File that a path in a configuration names; relative ones begin in the directory.");
}

}  // namespace inverse_dynamics_tools
