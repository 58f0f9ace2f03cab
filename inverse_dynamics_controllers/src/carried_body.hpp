// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the arm carries: a rigid body at its tip that comes and goes while the controller runs.
#pragma once

#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_control/payload_ramp.hpp>
#include <memory>

#include "arm.hpp"
#include "parameter_watch.hpp"

namespace inverse_dynamics_controllers {

/// Gives the solver the body that the parameters `payload.*` or the topic ~/payload say last.
///
/// A change takes `payload.ramp_time`, in steps of 10 ms of the node's executor; the control loop
/// has no part in it. What can't be a body is refused with a reason, and changes nothing.
class CarriedBody {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: the parameters make no
  /// possible body, or the solver can't carry any.
  explicit CarriedBody(const Setup& setup);

 private:
  // A message that is being received keeps it.
  std::shared_ptr<inverse_dynamics_control::PayloadRamp> ramp_;
  std::unique_ptr<ParameterWatch> watch_;
  rclcpp::Subscription<geometry_msgs::msg::InertiaStamped>::SharedPtr subscription_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_controllers
