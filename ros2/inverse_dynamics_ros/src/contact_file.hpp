// SPDX-License-Identifier: Apache-2.0

/// @file
/// Thresholds and noise of external torques that `ids contact` has found: its contacts.json.

#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

/// Options of the estimator, and statistics of its estimates without contact.
struct ContactFile {
  double gain = 0.0;               ///< 1/s
  std::optional<double> tracking;  ///< rad/s
  bool measured_velocities = false;
  std::vector<double> friction_band;  ///< N m, one per joint, or one for all; empty: none
  Eigen::VectorXd thresholds, noise;  ///< n each, in the order of the joints; N m (prismatic N)
};

/// Reads it. @param joint_names  n, as the solver has them.
/// @throws UserError: a file that can't be read or isn't one of `ids contact`, one of other joints.
ContactFile readContactFile(const std::string& path, const std::vector<std::string>& joint_names);

}  // namespace inverse_dynamics_ros
