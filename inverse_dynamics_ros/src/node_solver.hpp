// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the user has given a node of its parameters.

#pragma once

#include <inverse_dynamics_solver/parameters.hpp>
#include <rclcpp/node.hpp>

#include "robot_parameters.hpp"

namespace inverse_dynamics_ros {

/// Declares what the user gives below `ids.`: which parameters a solver has, only it knows.
void declareSolverParameters(rclcpp::Node& node);

/// What is set from outside (launch file, command line), without defaults.
///
/// @param prefix  of the names that are meant, which is left out: `retime.`.
/// @throws inverse_dynamics_solver::InvalidParameterValueException: byte arrays.
inverse_dynamics_solver::Parameters givenParameters(rclcpp::Node& node,
                                                    const std::string& prefix = "");

}  // namespace inverse_dynamics_ros
