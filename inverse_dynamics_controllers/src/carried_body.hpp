// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the arm carries: a rigid body at its tip that comes and goes while the controller runs.
///
///     CarriedBody carried(setup);      // from then on parameters and ~/payload are the solver's
#pragma once

#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <memory>

#include "arm.hpp"
#include "parameter_watch.hpp"

namespace inverse_dynamics_controllers {

/// The body between two others: all inertial parameters change linearly, so that torques do too.
///
/// @param from, to  possible bodies, with the tip frame as theirs.
/// @param part      0: from; 1: to.
inverse_dynamics_solver::RigidBody between(const inverse_dynamics_solver::RigidBody& from,
                                           const inverse_dynamics_solver::RigidBody& to,
                                           double part);

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
  struct Ramp;

  std::shared_ptr<Ramp> ramp_;  // a message that is being received keeps it
  std::unique_ptr<ParameterWatch> watch_;
  rclcpp::Subscription<geometry_msgs::msg::InertiaStamped>::SharedPtr subscription_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace inverse_dynamics_controllers
