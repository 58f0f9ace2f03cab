// SPDX-License-Identifier: Apache-2.0
#include "run_configuration.hpp"

#include <pybind11/stl.h>

#include <chain_dynamics/located_yaml.hpp>
#include <inverse_dynamics_evaluation/package_share.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <optional>
#include <string>
#include <vector>

#include "annotations.hpp"
#include "description.hpp"
#include "initialized.hpp"
#include "solver.hpp"
#include "solver_origin.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using evaluation::RunConfiguration;
using evaluation::RunConfigurationChanges;
using Names = std::vector<std::string>;

/// A path, as Python's os.fsdecode() makes it of its bytes.
py::object pathOf(const std::string& path) {
  if (path.empty()) return py::none();
  return py::module_::import("pathlib").attr("Path")(
      py::module_::import("os").attr("fsdecode")(py::bytes(path)));
}

/// The bytes of a path, or of nothing.
std::string bytesOf(const py::handle& path) {
  if (path.is_none()) return "";
  return py::module_::import("os").attr("fsencode")(path).cast<std::string>();
}

/// Fields of robots.py's Robot.
py::dict fieldsOf(const RunConfiguration& robot) {
  py::dict parameters;
  for (const auto& [name, value] : robot.parameters) parameters[py::str(name)] = py::cast(value);
  py::dict fields;
  fields["name"] = robot.name;
  fields["description"] = robot.description;
  fields["file"] = pathOf(robot.file);
  fields["plugin"] = robot.plugin;
  fields["urdf"] = pathOf(robot.urdf);
  fields["model"] = pathOf(robot.model);
  fields["root"] = robot.root;
  fields["tip"] = robot.tip;
  fields["gravity"] = robot.gravity ? py::object(py::tuple(py::cast(*robot.gravity))) : py::none();
  fields["friction"] = robot.friction;
  fields["topic"] = robot.topic;
  fields["joints"] = py::tuple(py::cast(robot.joints));
  fields["effort"] = robot.effort;
  fields["drive_gains"] = py::tuple(py::cast(robot.drive_gains));
  fields["accelerations"] = robot.accelerations;
  fields["cutoff"] = robot.cutoff;
  fields["parameters"] = parameters;
  fields["source"] = robot.source;
  return fields;
}

evaluation::SolverParameters parametersOf(const py::handle& parameters) {
  evaluation::SolverParameters found;
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(parameters)) {
    addParameter(name.cast<std::string>(), value, found);
  }
  return found;
}

/// What a Robot says.
RunConfiguration configurationOf(const py::object& robot) {
  RunConfiguration found;
  const auto take = [&robot](const char* name, auto& field) {
    field = robot.attr(name).cast<std::decay_t<decltype(field)>>();
  };
  take("name", found.name);
  take("description", found.description);
  take("plugin", found.plugin);
  take("root", found.root);
  take("tip", found.tip);
  take("gravity", found.gravity);
  take("friction", found.friction);
  take("topic", found.topic);
  take("joints", found.joints);
  take("effort", found.effort);
  take("drive_gains", found.drive_gains);
  take("accelerations", found.accelerations);
  take("cutoff", found.cutoff);
  take("source", found.source);
  found.file = bytesOf(robot.attr("file"));
  found.urdf = bytesOf(robot.attr("urdf"));
  found.model = bytesOf(robot.attr("model"));
  found.parameters = parametersOf(robot.attr("parameters"));
  return found;
}

/// Changes by the names of a Robot's fields; what isn't there stays.
RunConfigurationChanges changesOf(const py::dict& given) {
  RunConfigurationChanges changes;
  const auto take = [&given](const char* name, auto& change) {
    if (given.contains(name)) change = given[name].cast<std::decay_t<decltype(change)>>();
  };
  take("plugin", changes.plugin);
  take("root", changes.root);
  take("tip", changes.tip);
  take("gravity", changes.gravity);
  take("friction", changes.friction);
  take("topic", changes.topic);
  take("joints", changes.joints);
  take("effort", changes.effort);
  take("drive_gains", changes.drive_gains);
  take("accelerations", changes.accelerations);
  take("cutoff", changes.cutoff);
  if (given.contains("urdf")) changes.urdf = bytesOf(given["urdf"]);
  if (given.contains("parameters")) changes.parameters = parametersOf(given["parameters"]);
  return changes;
}

evaluation::EffortOptions effortOptions(const py::object& robot, const py::object& solver,
                                        const std::optional<std::string>& option,
                                        const std::string& format) {
  evaluation::EffortOptions options =
      evaluation::effortOptions(configurationOf(robot), *solverOf(solver));
  options.option = option;
  options.format = format;
  return options;
}

}  // namespace

void bindRunConfiguration(py::module_& module) {
  module.def("robot_names", &evaluation::robotNames,
             "Names of the run configurations that the sourced workspaces bring.");
  module.def(
      "read_robot",
      [](const PathText& name_or_file) {
        return fieldsOf(evaluation::readRunConfiguration(name_or_file.bytes));
      },
      py::arg("name_or_file"), "Fields of the Robot of that name, or of that file.");
  module.def(
      "change_robot",
      [](const py::object& robot, const py::dict& changes) {
        return fieldsOf(evaluation::withChanges(configurationOf(robot), changesOf(changes)));
      },
      py::arg("robot"), py::arg("changes"),
      "Fields of a Robot with changes, by the names of its fields.");
  module.def(
      "recorded_names",
      [](const py::object& robot, const Names& joint_names) {
        return evaluation::recordedNames(configurationOf(robot), joint_names);
      },
      py::arg("robot"), py::arg("joint_names"),
      "Names in a recording of the solver's joints, in the order of the chain.");
  module.def("effort_options", &effortOptions, py::arg("robot"), py::arg("solver"),
             py::arg("option") = py::none(), py::arg("format") = "",
             "What is stated of efforts: by a Robot, the user, the recording's format.");
  module.def(
      "solver_parameters",
      [](const chain_dynamics::LocatedMap& mapping) {
        py::dict parameters;
        for (const auto& [name, value] : evaluation::readSolverParameters(mapping)) {
          parameters[py::str(name)] = py::cast(value);
        }
        return parameters;
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
