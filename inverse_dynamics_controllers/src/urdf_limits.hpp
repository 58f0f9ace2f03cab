// SPDX-License-Identifier: Apache-2.0
/// @file
/// The limits of joints that a robot description states.
#pragma once

#include <inverse_dynamics_control/reference_guard.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// Limits of n joints; infinity where the description states none.
struct UrdfLimits {
  inverse_dynamics_control::ReferenceLimits reference;
  Eigen::VectorXd effort;  ///< n; N m (prismatic N)
};

/// @param robot_description  URDF text; empty: there are no limits.
/// @param joints             names of the hardware; one that isn't in the description has no
/// limits. Throws inverse_dynamics_solver::InvalidRobotDescriptionException: not a URDF.
UrdfLimits urdfLimits(const std::string& robot_description, const std::vector<std::string>& joints);

}  // namespace inverse_dynamics_controllers
