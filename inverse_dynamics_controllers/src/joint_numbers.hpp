// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters that hold a number per joint.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// One number per joint; a single number stands for all joints.
///
/// @param name  of the parameter, for the text of errors.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: another number of numbers.
Eigen::VectorXd jointNumbers(const std::string& name, const std::vector<double>& values,
                             const std::vector<std::string>& joints);

/// The same, or `otherwise` where the parameter is empty.
Eigen::VectorXd jointNumbers(const std::string& name, const std::vector<double>& values,
                             const std::vector<std::string>& joints,
                             const Eigen::VectorXd& otherwise);

}  // namespace inverse_dynamics_controllers
