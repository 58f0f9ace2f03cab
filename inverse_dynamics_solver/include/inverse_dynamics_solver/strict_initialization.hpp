// SPDX-License-Identifier: Apache-2.0
/// @file
/// A solver initialized with the parameters of a node, of which it must know all in its namespace:
/// a misspelt one would silently leave the default.
///
///     initializeStrictly(*solver, node->get_node_parameters_interface(), "ids", urdf);
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The same with the names of the parameters that the user has set, in any namespace.
void initializeStrictly(InverseDynamicsSolver& solver, const Parameters& parameters,
                        const std::string& param_namespace, const std::string& robot_description,
                        const std::vector<std::string>& names);

/// Initializes the solver, and sees that it has asked for every parameter of its namespace.
///
/// @param parameters  rclcpp's NodeParametersInterface.
/// Throws as InverseDynamicsSolver::initialize(), and InvalidParameterValueException: one that the
/// solver doesn't know; then the solver is initialized nevertheless, without it.
template <class Interface>
void initializeStrictly(InverseDynamicsSolver& solver, const std::shared_ptr<Interface>& parameters,
                        const std::string& param_namespace, const std::string& robot_description) {
  constexpr int kAllDepths = 0;
  initializeStrictly(solver, parameters, param_namespace, robot_description,
                     parameters->list_parameters({param_namespace}, kAllDepths).names);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
