// SPDX-License-Identifier: Apache-2.0
/// @file
/// Damping of the safe torque and of hand guiding, from the parameters damping.*, which may change
/// while the loop runs.
#pragma once

#include <Eigen/Core>

#include "arm.hpp"
#include "changing_gains.hpp"

namespace inverse_dynamics_controllers {

/// N m s/rad (prismatic N s/m) of each joint: damping.values, or of damping.rate and .posture.
///
/// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value, also those of
/// a change, which is refused then. ParameterUninitializedException: no period where one is needed.
ChangingGains<Eigen::VectorXd> changingDamping(const Setup& setup);

}  // namespace inverse_dynamics_controllers
