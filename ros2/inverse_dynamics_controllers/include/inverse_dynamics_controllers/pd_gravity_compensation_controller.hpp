// SPDX-License-Identifier: Apache-2.0
/// @file
/// PD control of the joints with gravity compensation.
///
///     tau = g(q) + P e + D ed + f
///
/// For holding positions and slow motions, with any solver: nothing of the model is needed but
/// gravity. docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include "inverse_dynamics_controllers/following_controller.hpp"

namespace inverse_dynamics_controllers {

/// The law PdGravityCompensation of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class PdGravityCompensationController : public FollowingController {
 protected:
  MakeFollower declareParameters() override;
};

}  // namespace inverse_dynamics_controllers
