// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/load_friction.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/torque_deviation.hpp>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "solver_class.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;

MaybeFloats arrayOrNone(const Eigen::VectorXd& vector) {
  if (vector.size() == 0) return py::none();
  return arrayOf(vector);
}

MaybeFloats driveGains(const Solver& solver) {
  const auto* motors = solver.find<ids::MotorCurrents>();
  return arrayOrNone(motors ? motors->getDriveGainsMatrix().diagonal() : Eigen::VectorXd());
}

MaybeFloats torqueDeviation(const Solver& solver) {
  const auto* band = solver.find<ids::TorqueDeviation>();
  const bool known = band != nullptr && band->hasTorqueDeviation();
  return arrayOrNone(known ? band->getTorqueDeviation() : Eigen::VectorXd());
}

NameTuple jointTypes(const Solver& solver) {
  const auto name = [](chain_dynamics::JointType type) {
    return type == chain_dynamics::JointType::kPrismatic    ? "prismatic"
           : type == chain_dynamics::JointType::kContinuous ? "continuous"
                                                            : "revolute";
  };
  std::vector<std::string> names;
  for (const auto type : solver.get().jointTypes()) names.emplace_back(name(type));
  return tupleOf(names);
}

MaybeFloats seenRanges(const Solver& solver) {
  const auto* band = solver.find<ids::TorqueDeviation>();
  if (band == nullptr || band->seenRanges().empty()) return py::none();
  const auto& ranges = band->seenRanges();
  py::array_t<double> result(Shape{3, static_cast<py::ssize_t>(ranges.size()), 2});
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    const chain_dynamics::Interval of_joint[] = {ranges[j].q, ranges[j].qd, ranges[j].qdd};
    for (int k = 0; k < 3; ++k) {
      result.mutable_at(k, j, 0) = of_joint[k].lower;
      result.mutable_at(k, j, 1) = of_joint[k].upper;
    }
  }
  return py::object(std::move(result));  // GCC 14 calls a plain move redundant, others need one
}

/// A text among the parameters; empty: none.
std::string textParameter(const Solver& solver, const std::string& name) {
  const auto& parameters = solver.origin().parameters;
  const auto found = parameters.find(name);
  const auto* const text =
      found == parameters.end() ? nullptr : std::get_if<std::string>(&found->second);
  return text == nullptr ? "" : *text;
}

/// Of the description, a RobotDescription of Python.
py::object describedBy(const Solver& solver) {
  return py::module_::import("inverse_dynamics._core")
      .attr("RobotDescription")(solver.origin().urdf);
}

std::string rootOf(const Solver& solver) {
  std::string stated = textParameter(solver, "root");
  if (!stated.empty() || solver.origin().urdf.empty()) return stated;
  return describedBy(solver).attr("root").cast<std::string>();
}

std::string tipOf(const Solver& solver) {
  std::string first = solver.get().tipNames().front();
  if (!first.empty() || solver.origin().urdf.empty()) return first;
  return describedBy(solver).attr("tip")(solver.joints().back()).cast<std::string>();
}

/// Those that are stated, by name. zero: whether zero is, too, as in a description.
py::dict stated(const chain_dynamics::JointLimits& limits, bool zero) {
  py::dict found("lower"_a = limits.lower, "upper"_a = limits.upper);
  for (const auto& [name, limit] :
       {std::pair("velocity", limits.velocity), std::pair("effort", limits.effort),
        std::pair("acceleration", limits.acceleration),
        std::pair("deceleration", limits.deceleration), std::pair("jerk", limits.jerk)}) {
    if ((zero || limit > 0) && std::isfinite(limit)) found[name] = limit;
  }
  return found;
}

/// Whether the solver's robot is a tree of the description: it has several tips, motors, or joints that mimic
/// others.
bool isTree(const Solver& solver, const chain_dynamics::RobotDescription& robot) {
  const std::vector<std::string>& tips = solver.get().tipNames();
  const auto& parameters = solver.origin().parameters;
  const auto motors = parameters.lower_bound("motors");
  if (tips.size() > 1 || (motors != parameters.end() && motors->first.rfind("motors", 0) == 0)) {
    return true;
  }
  std::size_t link = robot.linkIndex(tips.front());
  while (link != robot.kNone && robot.links[link].parent_joint != robot.kNone) {
    const auto& joint = robot.joints[robot.links[link].parent_joint];
    if (joint.mimic) return true;
    link = joint.parent;
  }
  return false;
}

/// The coordinates of a tree, those of its model file or which joints that mimic them restrict.
std::vector<chain_dynamics::Joint> treeJoints(const Solver& solver) {
  const std::string model = textParameter(solver, "model");
  if (!model.empty()) return chain_dynamics::modelFromFile(model).chain.joints();
  const auto& origin = solver.origin();
  const auto configuration = ids::readConfiguration(origin.parameters, "", origin.urdf);
  return mechanismFromDescription(configuration).coordinates.joints();
}

/// (n,) each, by name; infinite where none is stated.
ParameterDict limitsOf(const Solver& solver) {
  py::list joints;
  const std::string model = textParameter(solver, "model");
  if (!solver.origin().urdf.empty()) {
    const auto robot = chain_dynamics::robotFromUrdf(solver.origin().urdf);
    if (isTree(solver, robot)) {
      for (const auto& joint : treeJoints(solver)) joints.append(stated(joint.limits, true));
    } else {
      const py::object chain = describedBy(solver).attr("chain")(tupleOf(solver.joints()),
                                                                 textParameter(solver, "root"));
      for (const auto& joint : chain) joints.append(joint.attr("limits"));
    }
  } else if (std::filesystem::is_regular_file(model)) {
    const auto from_file = chain_dynamics::modelFromFile(model);
    for (const auto& joint : from_file.chain.joints()) joints.append(stated(joint.limits, false));
  }
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto n = static_cast<Eigen::Index>(solver.joints().size());
  std::map<std::string, Eigen::VectorXd> found;
  for (const char* const name : {"lower", "upper", "velocity", "effort"}) {
    found[name].setConstant(n, name == std::string("lower") ? -kNone : kNone);
  }
  for (Eigen::Index j = 0; j < std::min(n, static_cast<Eigen::Index>(joints.size())); ++j) {
    for (const auto& [name, value] : py::dict(joints[static_cast<std::size_t>(j)])) {
      const auto [of, is_new] = found.try_emplace(name.cast<std::string>());
      if (is_new) of->second.setConstant(n, kNone);
      of->second[j] = value.cast<double>();
    }
  }
  py::dict limits;
  for (const auto& [name, values] : found) limits[name.c_str()] = arrayOf(values);
  return ParameterDict(limits);
}

}  // namespace

void bindProperties(py::class_<Solver>& solver) {
  solver
      .def_property_readonly(
          "plugin", [](const Solver& s) { return s.origin().plugin; }, "package/Class.")
      .def_property_readonly(
          "robot", [](const Solver& s) { return s.origin().robot; },
          "The run configuration that the solver was made of, with all arguments.")
      .def_property_readonly(
          "urdf", [](const Solver& s) { return s.origin().urdf; },
          "Text of the robot description; empty: none was given.")
      .def_property_readonly("root", &rootOf,
                             "Link that the chain begins at; empty: no description says it.")
      .def_property_readonly("tip", &tipOf,
                             "Link that the chain ends at, of a tree the first tip; empty: no\n"
                             "description says it.")
      .def_property_readonly(
          "tip_names", [](const Solver& s) { return tupleOf(s.get().tipNames()); },
          "Links that are tips, of a chain one; an empty name: that of a model file\n"
          "without a stated tip.")
      .def_property_readonly(
          "limits", &limitsOf,
          "Of the joints, by name, (n,) each: lower, upper (rad, m), velocity\n"
          "(rad/s, m/s), effort (N m, N) and what else the description or the model\n"
          "file states. Infinite where nothing is stated.")
      .def_property_readonly(
          "joint_names", [](const Solver& s) { return tupleOf(s.joints()); },
          "Names of the joints, from root to tip, of a tree in the order of the\n"
          "description: the order of all arrays. Joints that mimic aren't among them.")
      .def_property_readonly("joint_types", &jointTypes,
                             "revolute, continuous or prismatic, of each joint. Positions of a\n"
                             "continuous joint that differ by whole turns are the same.")
      .def_property_readonly(
          "warnings", [](const Solver& s) { return tupleOf(s.get().warnings()); },
          "Warnings about the robot that don't prevent computing, one sentence each.")
      .def_property_readonly(
          "inertia_is_physical", [](const Solver& s) { return s.get().inertiaIsPhysical(); },
          "Whether H is symmetric and positive definite by construction.")
      .def_property_readonly("drive_gains", &driveGains,
                             "(n,) N m/A (prismatic N/A) of a model identified in motor\n"
                             "currents; None of any other.")
      .def_property_readonly(
          "friction_depends_on_position",
          [](const Solver& s) { return ids::frictionDependsOnPosition(s.get()); },
          "Whether friction grows with the gravity torques: then friction_vector() needs q.")
      .def_property_readonly(
          "torque_deviation", &torqueDeviation,
          "(n,) N m (prismatic N): half the width of the band that holds 95 %\n"
          "of the differences between measured and computed torques of data\n"
          "that weren't used to identify; None where the model doesn't state it.")
      .def_property_readonly("seen", &seenRanges,
                             "(3, n, 2): least and greatest q, qd, qdd of the data of\n"
                             "identification; None where the model doesn't state it.");
}

}  // namespace inverse_dynamics_tools
