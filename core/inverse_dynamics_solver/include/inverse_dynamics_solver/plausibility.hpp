// SPDX-License-Identifier: Apache-2.0
/// @file
/// Warnings of bodies and gravity that are implausible, most often numbers in other units.
///
///     const std::string doubt = doubtOf(body);   // a warning, or empty
///     if (!doubt.empty()) std::cerr << doubt << "\n";
///
/// InverseDynamicsSolver::warnings() holds those of the parameters of initialize().
#pragma once

#include <Eigen/Core>
#include <string>

#include "inverse_dynamics_solver/payload.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// A sentence about a body whose center of mass is 5 m or more from the tip, or whose radius of
/// gyration is as large; empty for any other.
std::string doubtOf(const RigidBody& body);

/// A sentence about gravity [m/s^2] that is neither zero nor that of a place between the Moon and
/// Jupiter; empty for any other.
std::string doubtOf(const Eigen::Vector3d& gravity);

}  // namespace v2
}  // namespace inverse_dynamics_solver
