// SPDX-License-Identifier: Apache-2.0

/// @file
/// Parameters that the user has set.

#pragma once

#include <inverse_dynamics_solver/parameters.hpp>
#include <rclcpp/node.hpp>
#include <string>

#include "robot_parameters.hpp"

namespace inverse_dynamics_ros {

/// Declares robot_parameters.yaml, and what the user gives below `ids.`: which parameters a solver
/// has, only it knows.
void declareRobotParameters(rclcpp::Node& node);

/// Parameters that are set from outside (launch file, command line), without defaults.
///
/// @param prefix  selects names, and is removed from them: `retime.`.
/// @throws inverse_dynamics_solver::InvalidParameterValueException: byte arrays.
inverse_dynamics_solver::Parameters givenParameters(rclcpp::Node& node,
                                                    const std::string& prefix = "");

}  // namespace inverse_dynamics_ros
