// SPDX-License-Identifier: Apache-2.0

/// @file
/// What measured efforts mean, and so what is compared with what.
///
///     torque                    effort [N m] with the computed torque
///     current                   drive gain x effort [A] with the computed torque
///     torque_without_gravity    effort [N m] with computed torque - gravity, as newer UR drivers
///                               send

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

/// Meaning of efforts, and the drive gains of currents.
struct EffortMeaning {
  bool without_gravity = false;
  Eigen::VectorXd drive_gains;  ///< n; N m/A (prismatic N/A); ones where efforts aren't currents
  std::string summary;          ///< in words
};

/// The meaning that the parameters `effort` and `drive_gains` state.
///
/// @param drive_gains  n, or none: those of the solver.
/// @throws UserError: currents without drive gains; wrong number of them; one that isn't above 0.
EffortMeaning effortMeaning(const std::string& effort, const std::vector<double>& drive_gains,
                            const inverse_dynamics_solver::InverseDynamicsSolver& solver);

}  // namespace inverse_dynamics_ros
