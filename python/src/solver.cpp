// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <array>
#include <filesystem>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "description.hpp"
#include "parameters.hpp"
#include "solver_class.hpp"
#include "tips.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;

using Robot = inverse_dynamics_evaluation::RunConfiguration;
using SolverName = std::variant<Robot, PathText>;

/// The chain whose links and joints may be given as frames of Jacobians.
FramesOf framesOf(const ParameterValues& parameters, std::vector<std::string> joints) {
  const std::string locked = "locked_joints.";
  FramesOf of{"", std::move(joints), {}};
  for (const auto& [name, value] : parameters) {
    const auto* const position = std::get_if<double>(&value);
    if (name == "root") of.root = std::get<std::string>(value);
    if (position && name.rfind(locked, 0) == 0) of.locked[name.substr(locked.size())] = *position;
  }
  return of;
}

constexpr const char* kUsualPlugin =
    "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";

/// The robot of a Robot, a name of robot_names(), the file of a run configuration, `package/Class`, or
/// a package without its ending. Nothing, with a description or a model: the usual plugin.
Robot robotOf(const SolverName& named, bool described) {
  if (const auto* const robot = std::get_if<Robot>(&named)) return *robot;
  const std::string& text = std::get<PathText>(named).bytes;
  Robot robot;
  robot.name = "robot";
  robot.effort = inverse_dynamics_evaluation::kAutomatic;
  robot.plugin = text.empty() && described ? kUsualPlugin : text;
  if (robot.plugin.empty()) {
    throw ids::InvalidParameterValueException(
        ids::errorText("Solver", "", "a robot, a plugin, urdf= or model=", "none",
                       "`ids robots` lists the names of both"));
  }
  const std::string ending = std::filesystem::path(text).extension();
  const bool is_file = ending == ".yaml" || ending == ".yml";
  if (!is_file && robot.plugin.find('/') != std::string::npos) return robot;
  for (const std::string& plugin : ids::SolverLoader().availableSolvers()) {
    if (is_file || plugin.rfind(text + "_inverse_dynamics_solver/", 0) != 0) continue;
    robot.plugin = plugin;
    return robot;
  }
  return inverse_dynamics_evaluation::readRunConfiguration(text);
}

/// The robot with parameters of a solver in the fields that it has for them.
Robot stating(Robot robot, const ParameterValues& parameters) {
  robot.parameters.clear();
  for (const auto& [name, value] : parameters) {
    const auto* const text = std::get_if<std::string>(&value);
    const auto* const truth = std::get_if<bool>(&value);
    const auto* const numbers = std::get_if<std::vector<double>>(&value);
    const auto* const names = std::get_if<std::vector<std::string>>(&value);
    if (name == "friction" && truth) {
      robot.friction = *truth;
    } else if (name == "gravity" && numbers && numbers->size() == 3) {
      robot.gravity = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    } else if (names && name == "tip") {
      robot.tip = textOf(*names);
    } else if (text && (name == "root" || name == "tip" || name == "model")) {
      (name == "root" ? robot.root : name == "tip" ? robot.tip : robot.model) = *text;
    } else {
      robot.parameters[name] = value;
    }
  }
  return robot;
}

std::unique_ptr<Solver> makeSolver(const SolverName& named, const Description& urdf,
                                   const std::string& root, const Tips& tips,
                                   const std::optional<std::array<double, 3>>& gravity,
                                   const std::optional<bool>& friction, const std::string& attached,
                                   const std::optional<std::string>& model,
                                   const ParameterDict& parameters) {
  Robot robot = robotOf(named, !urdf.text.empty() || model);
  const bool described = urdf.text.empty() && !robot.urdf.empty();
  Origin origin{robot.plugin,
                described ? readDescription(textOf(robot.urdf)) : urdf.text,
                parametersOf(parameters),
                {}};
  const auto give = [&](const std::string& name, const ids::ParameterValue& value) {
    if (origin.parameters.emplace(name, value).second) return;
    throw ids::InvalidParameterValueException(
        ids::errorText("Solver", "", "each parameter once",
                       "argument " + name + " and parameters['" + name + "']", "leave out one"));
  };
  if (friction) give("friction", *friction);
  if (!root.empty()) give("root", root);
  if (const std::string tip = textOf(tips); !tip.empty()) give("tip", tip);
  if (!attached.empty()) give("attached", attached);
  if (model) give("model", *model);
  if (gravity) give("gravity", std::vector<double>(gravity->begin(), gravity->end()));
  // what the robot states and no argument replaces
  if (!urdf.text.empty()) replaceDescription(robot, urdf.path);
  const auto own = inverse_dynamics_evaluation::solverParameters(robot);
  origin.parameters.insert(own.begin(), own.end());
  origin.robot = stating(std::move(robot), origin.parameters);
  return std::make_unique<Solver>(std::move(origin));
}

/// State for pickle and copy: what made the solver, and what was set since.
py::tuple stateOf(const Solver& solver) {
  const Origin& origin = solver.origin();
  return py::make_tuple(origin.plugin, origin.urdf, dictOf(origin.parameters), origin.robot,
                        changesOf(solver));
}

std::unique_ptr<Solver> restored(const py::tuple& state) {
  auto solver =
      std::make_unique<Solver>(Origin{state[0].cast<std::string>(), state[1].cast<std::string>(),
                                      parametersOf(state[2]), state[3].cast<Robot>()});
  change(*solver, state[4]);
  return solver;
}

std::string represented(const Solver& solver) {
  const std::vector<std::string>& joints = solver.joints();
  const std::string joints_in_words =
      joints.size() == 1
          ? "joint " + joints[0]
          : std::to_string(joints.size()) + " joints, " + joints.front() + " to " + joints.back();
  return "<Solver " + solver.origin().plugin + ": " + joints_in_words + ">";
}

}  // namespace

Solver::Solver(Origin origin) : origin_(std::move(origin)) {
  const py::gil_scoped_release release;
  solver_ = ids::SolverLoader().load(origin_.plugin);
  solver_->initialize(ids::Parameters(origin_.parameters).strict(), "", origin_.urdf);
  frames_ = std::make_unique<Frames>(origin_.urdf, framesOf(origin_.parameters, joints()));
}

std::shared_ptr<const ids::InverseDynamicsSolver> solverOf(const py::handle& object) {
  if (!py::isinstance<Solver>(object)) {
    throw py::type_error(ids::errorText("argument solver", "", "a Solver",
                                        py::str(py::type::handle_of(object).attr("__name__"))));
  }
  return object.cast<const Solver&>().shared();
}

void bindSolver(py::module_& module) {
  module.def(
      "available_solvers", [] { return ids::SolverLoader().availableSolvers(); },
      R"(Names of the installed solver plugins, sorted; none if no workspace is sourced.

Returns
-------
list of str

Examples
--------
>>> from inverse_dynamics import available_solvers
>>> "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL" in available_solvers()
True)");

  py::class_<Solver> solver(module, "Solver",
                            R"(An inverse dynamics solver, made by name and ready to compute.

Arrays are (n,), one state, or (N, n), one state per row, joints in the order of joint_names; results have
the same shape. (n,) among (N, n) is one state for all. Columns of a DataFrame that are named like the joints are
taken by name. Any layout, without copies. Threads: safe; the GIL is released. Pickled, it is made again.

Parameters
----------
plugin : Robot, str or path, optional
    A Robot, a name of robot_names() or the file of a run configuration; or a plugin: one of
    available_solvers(), or its package without the ending, such as "kdl". By default rigid bodies.
    What follows replaces what the robot states; what isn't given has the solver's default.
urdf : str or path, optional
    Text of the description, or path of a .urdf or .xacro file.
root : str, optional
    Link that the chain begins at; by default the first.
tip : str or sequence of str, optional
    Link that it ends at; by default the last. Several, or "*" for all leaves: a tree.
gravity : sequence of 3 floats, optional
    m/s^2, in the axes of the root link.
friction : bool, optional
    Whether the solver adds its friction model.
attached : {"lump", "ignore"}, optional
    Whether links that are attached to the chain count.
model : str, optional
    File or name of a model.
parameters : dict, optional
    Others of the solver, by name; batch_threads: number of threads that may share a large batch.

Raises
------
SolverError
    See inverse_dynamics.errors.

Examples
--------
>>> from inverse_dynamics import Solver, load_robot
>>> arm = Solver("kdl", urdf=load_robot("ur10_simulated").urdf, gravity=[0, 0, -1.62])
>>> arm
<Solver kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL: 6 joints, shoulder_pan_joint to wrist_3_joint>
>>> arm.torques([0.5] * 6, [0] * 6, [0] * 6).shape
(6,))");
  solver
      .def(py::init(&makeSolver), "plugin"_a = "", "urdf"_a = "", "root"_a = "", "tip"_a = "",
           "gravity"_a = py::none(), py::kw_only(), "friction"_a = py::none(), "attached"_a = "",
           "model"_a = py::none(), "parameters"_a = py::dict())
      .def("__repr__", &represented)
      .def(py::pickle(&stateOf, &restored));
  bindProperties(solver);
  bindQuantities(solver);
  bindChanges(solver);
  bindFrictionState(module, solver);
}

}  // namespace inverse_dynamics_tools
