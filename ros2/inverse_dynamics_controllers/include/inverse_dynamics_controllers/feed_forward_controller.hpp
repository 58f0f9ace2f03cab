// SPDX-License-Identifier: Apache-2.0
/// @file
/// The model's torque for the desired motion, added to the effort of another controller.
///
///     tau = effort + P e + D ed + H qdd_ref + C qd + g + f
///
/// Any solver will do: no error goes through H. Motion and effort come from the controllers before
/// it, or from the topic ~/reference; P and D are this controller's own gains, zero by default.
/// docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include "inverse_dynamics_controllers/following_controller.hpp"

namespace inverse_dynamics_controllers {

/// The law FeedForward of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class FeedForwardController : public FollowingController {
 protected:
  MakeFollower declareParameters() override;
};

}  // namespace inverse_dynamics_controllers
