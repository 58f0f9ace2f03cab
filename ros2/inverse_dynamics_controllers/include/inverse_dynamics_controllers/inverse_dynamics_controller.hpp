// SPDX-License-Identifier: Apache-2.0
/// @file
/// Computed torque control, also called inverse dynamics control, as a controller of ros2_control.
///
///     tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f
///
/// References come from the controller before it (a joint_trajectory_controller with
/// command_interfaces position, velocity, acceleration), or from the topic ~/reference.
/// docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include "inverse_dynamics_controllers/following_controller.hpp"

namespace inverse_dynamics_controllers {

/// The law ComputedTorque of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class InverseDynamicsController : public FollowingController {
 protected:
  MakeFollower declareParameters() override;
};

}  // namespace inverse_dynamics_controllers
