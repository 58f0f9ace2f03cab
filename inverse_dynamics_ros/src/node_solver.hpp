// SPDX-License-Identifier: Apache-2.0

/// @file
/// A solver made ready with the parameters of a node.
///
///     declareSolverParameters(*node);                       // ids.root, ids.tip, ids.gravity, ...
///     auto solver = makeSolver(*node, plugin_name, robot_description);
///     auto units = torqueUnits(*node, solver->jointNames(), robot_description);

#pragma once

#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <rclcpp/node.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

/// Namespace of a solver's parameters in a node.
inline const std::string kSolverNamespace = "ids";

/// Declares what the user gives below `ids.`: which parameters a solver has, only it knows.
void declareSolverParameters(rclcpp::Node& node);

/// A solver, initialized with the parameters below `ids.` and the description.
///
/// @param plugin_name        parameter of that name: `package/Class`.
/// @param robot_description  URDF text; empty: none.
/// @throws UserError: no plugin name.
/// @throws inverse_dynamics_solver::Exception: what the loader and the solver say; a parameter
/// below `ids.` that the solver doesn't know.
std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> makeSolver(
    rclcpp::Node& node, const std::string& plugin_name, const std::string& robot_description);

/// Unit of each joint's torque: N for a prismatic joint of the description, else N m.
std::vector<std::string> torqueUnits(rclcpp::Node& node,
                                     const std::vector<std::string>& joint_names,
                                     const std::string& robot_description);

/// Names in messages of the solver's joints: the given ones, which must be as many; none: its own.
///
/// @throws UserError: another number of names; the solver's names in another order.
std::vector<std::string> messageNames(const std::vector<std::string>& given,
                                      const std::vector<std::string>& joint_names);

/// What the parameters `effort` and `drive_gains` state.
///
/// @param drive_gains  n, or none: those of the solver.
/// @throws inverse_dynamics_evaluation::ConfigurationError: wrong number of gains; one that isn't
/// above 0.
inverse_dynamics_evaluation::EffortOptions effortOptions(
    const std::string& effort, const std::vector<double>& drive_gains,
    const std::string& plugin_name, const inverse_dynamics_solver::InverseDynamicsSolver& solver);

}  // namespace inverse_dynamics_ros
