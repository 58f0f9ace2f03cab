// SPDX-License-Identifier: Apache-2.0
/// @file
/// The body that the arm carries, which may change while the controller runs.
#pragma once

#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_control/carried_body.hpp>
#include <string>

#include "arm.hpp"

namespace inverse_dynamics_controllers {

using CarriedBodyOfNode = inverse_dynamics_control::CarriedBody<rclcpp_lifecycle::LifecycleNode,
                                                                geometry_msgs::msg::InertiaStamped>;

/// Gives the solver the body that the parameters `payload.*` or the topic ~/payload say last; the
/// control loop has no part in it.
class CarriedBody : public CarriedBodyOfNode {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: the parameters make no
  /// possible body, or the solver can't carry any.
  explicit CarriedBody(const Setup& setup)
      : CarriedBodyOfNode(*setup.node, rclcpp::SystemDefaultsQoS(), rclcpp::SubscriptionOptions(),
                          [logger = setup.node->get_logger()](const std::string& line) {
                            RCLCPP_ERROR(logger, "%s", line.c_str());
                          }) {
    use(rampOf(setup.arm.solver), setup.tip());
  }
};

}  // namespace inverse_dynamics_controllers
