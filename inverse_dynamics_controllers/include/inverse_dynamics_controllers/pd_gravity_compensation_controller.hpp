// SPDX-License-Identifier: Apache-2.0
/// @file
/// PD control of the joints with gravity compensation.
///
///     tau = g(q) + P e + D ed + f
///
/// For holding positions and slow motions, with any solver: nothing of the model is needed but
/// gravity. docs/ros2_controllers.md has the parameters, tuning, and what is promised.
#pragma once

#include <memory>

#include "inverse_dynamics_controllers/following_controller.hpp"

namespace pd_gravity_compensation_controller {
class ParamListener;
}

namespace inverse_dynamics_controllers {

/// The law PdGravityCompensation of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class PdGravityCompensationController : public FollowingController {
 public:
  PdGravityCompensationController();
  ~PdGravityCompensationController() override;

 protected:
  void declareParameters() override;
  std::unique_ptr<Follower> makeFollower(const Setup& setup,
                                         const reference_parameters::Params& references) override;

 private:
  std::shared_ptr<pd_gravity_compensation_controller::ParamListener> parameters_;
};

}  // namespace inverse_dynamics_controllers
