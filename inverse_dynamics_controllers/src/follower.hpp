// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law with the references it follows and the loop it runs in: what configuring makes.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "arm.hpp"
#include "control_loop.hpp"
#include "reference_input.hpp"

namespace inverse_dynamics_controllers {

/// One thread at a time. Real time: update(): no allocation, lock, exception or system call.
class Follower {
 public:
  Follower(ControlLoop loop, ReferenceInput input)
      : loop_(std::move(loop)), input_(std::move(input)) {}
  virtual ~Follower() = default;
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  ControlLoop& loop() noexcept { return loop_; }
  ReferenceInput& input() noexcept { return input_; }
  virtual inverse_dynamics_control::ControlLaw& law() noexcept = 0;

  /// Efforts tau of a cycle of dt seconds; the references have been read.
  virtual inverse_dynamics_control::Status update(const inverse_dynamics_control::JointState& state,
                                                  const std::vector<double>& references, double dt,
                                                  Eigen::VectorXd& tau) noexcept = 0;

 private:
  ControlLoop loop_;
  ReferenceInput input_;
};

/// References within the limits of the parameters, or of the robot description.
template <class Params>
ReferenceInput referenceInput(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                              const ReferenceLayout& layout, const Arm& arm, const Params& params) {
  const inverse_dynamics_control::ReferenceGuard guard(
      referenceLimits(arm, params.limits),
      jointNumbers("stop_deceleration", params.stop_deceleration, arm.joints), arm.joints);
  return {node, layout, arm.joints, guard, params.reference_timeout};
}

}  // namespace inverse_dynamics_controllers
