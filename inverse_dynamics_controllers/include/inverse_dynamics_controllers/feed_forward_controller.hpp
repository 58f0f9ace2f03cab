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

#include <memory>

#include "inverse_dynamics_controllers/following_controller.hpp"

namespace feed_forward_controller {
class ParamListener;
}

namespace inverse_dynamics_controllers {

/// The law FeedForward of inverse_dynamics_control behind ros2_control's interfaces.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class FeedForwardController : public FollowingController {
 public:
  FeedForwardController();
  ~FeedForwardController() override;

 protected:
  void declareParameters() override;
  std::unique_ptr<Follower> makeFollower(const Setup& setup,
                                         const reference_parameters::Params& references) override;

 private:
  std::shared_ptr<feed_forward_controller::ParamListener> parameters_;
};

}  // namespace inverse_dynamics_controllers
