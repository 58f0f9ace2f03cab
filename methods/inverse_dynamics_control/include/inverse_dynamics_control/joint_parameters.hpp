// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers of each joint from the parameters of a node and from a robot description.
///
///     const std::vector<std::string> joints = solver->jointNames();
///     const DescribedLimits described = describedLimits(urdf, joints);
///     const auto effort = jointNumbers("limits.effort", {}, joints, described.effort);

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_control/reference_guard.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// One number per joint; a single number stands for all joints.
///
/// @param name    of the parameter, for the text of errors.
/// @param values  1 or n, in any unit.
/// @param joints  n names.
/// @return        n numbers.
/// @throws inverse_dynamics_solver::InvalidParameterValueException: another number of values.
OwnedVector jointNumbers(const std::string& name, const std::vector<double>& values,
                         const std::vector<std::string>& joints);

/// The same, or `otherwise` where the parameter is empty.
OwnedVector jointNumbers(const std::string& name, const std::vector<double>& values,
                         const std::vector<std::string>& joints, const OwnedVector& otherwise);

/// Limits of n joints; infinity where a description states none.
struct DescribedLimits {
  ReferenceLimits reference;           ///< of motions
  OwnedVector effort;                  ///< n; N m (prismatic N)
  OwnedVector jerk;                    ///< n; rad/s^3 (prismatic m/s^3)
  std::vector<std::string> unknown{};  ///< joints that the description lacks
};

/// Limits of joints from a robot description.
///
/// @param robot_description  text of a URDF; empty: there are no limits.
/// @param joints             one that isn't in the description has no limits.
/// @throws inverse_dynamics_solver::InvalidRobotDescriptionException: not a URDF.
DescribedLimits describedLimits(const std::string& robot_description,
                                const std::vector<std::string>& joints);

}  // namespace v2
}  // namespace inverse_dynamics_control
