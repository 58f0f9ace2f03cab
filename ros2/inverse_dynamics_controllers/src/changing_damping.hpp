// SPDX-License-Identifier: Apache-2.0
/// @file
/// Damping of the safe torque and of hand guiding, from the parameters damping.*, which may change
/// while the loop runs.
#pragma once

#include <Eigen/Core>

#include "arm.hpp"
#include "changing_gains.hpp"

namespace inverse_dynamics_controllers {

/// As LawOptions has it.
struct Damping {
  Eigen::VectorXd of_joints;  ///< N m s/rad (prismatic N s/m): damping.values, or zeros
  double rate;                ///< 1/s: damping.rate where there are no values, or zero
};

/// The damping of the parameters.
///
/// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value, also those of
/// a change, which is refused then.
ChangingGains<Damping> changingDamping(const Setup& setup);

}  // namespace inverse_dynamics_controllers
