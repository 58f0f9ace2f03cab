// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters that may change while a controller runs.
#pragma once

#include <inverse_dynamics_control/parameter_watch.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

namespace inverse_dynamics_controllers {

using ParameterWatch = inverse_dynamics_control::ParameterWatch<rclcpp_lifecycle::LifecycleNode>;
using ParameterValues = ParameterWatch::Values;

}  // namespace inverse_dynamics_controllers
