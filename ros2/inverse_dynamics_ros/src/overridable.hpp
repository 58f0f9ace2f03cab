// SPDX-License-Identifier: Apache-2.0

/// @file
/// Publishers and subscriptions whose quality of service users may set by parameters.

#pragma once

#include <rclcpp/qos_overriding_options.hpp>

namespace inverse_dynamics_ros {

/// Options with history, depth and reliability by parameters `qos_overrides.TOPIC...`.
template <class Options>
Options overridable() {
  Options options;
  options.qos_overriding_options = rclcpp::QosOverridingOptions::with_default_policies();
  return options;
}

}  // namespace inverse_dynamics_ros
