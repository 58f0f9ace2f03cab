// SPDX-License-Identifier: Apache-2.0
/// @file
/// A solver initialized with the parameters of a node, of which it must know all in its namespace:
/// a misspelt one would leave the default, with a warning only.
///
///     initializeStrictly(*solver, node->get_node_parameters_interface(), "ids", urdf);
#pragma once

#include <string>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Initializes the solver, or leaves it as it was.
///
/// @param parameters       rclcpp's NodeParametersInterface, or another source that can list its
///     parameters: see Parameters::strict().
/// @param param_namespace  the solver must know all parameters below it. Without a namespace, of a
///     node's parameters those that are near to one of the solver's: a node has others of its own.
/// Throws as InverseDynamicsSolver::initialize(), and InvalidParameterValueException: a parameter
/// that the solver doesn't know.
inline void initializeStrictly(InverseDynamicsSolver& solver, const Parameters& parameters,
                               const std::string& param_namespace,
                               const std::string& robot_description) {
  solver.initialize(parameters.strict(), param_namespace, robot_description);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
