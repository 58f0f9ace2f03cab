// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law's gains, from parameters that may change while the loop runs.
#pragma once

#include <functional>
#include <inverse_dynamics_control/parameter_watch.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

#include "latest_value.hpp"

namespace inverse_dynamics_controllers {

using ParameterWatch = inverse_dynamics_control::ParameterWatch<rclcpp_lifecycle::LifecycleNode>;
using ParameterValues = ParameterWatch::Values;

/// @tparam Gains  of the law; numbers of joints.
template <class Gains>
class ChangingGains {
 public:
  /// Gains of the parameters' values. Throws: they don't fit.
  using Make = std::function<Gains(const ParameterValues&)>;

  /// @param names  declared parameters of the node.
  /// Throws what `make` throws.
  ChangingGains(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                const std::vector<std::string>& names, const Make& make)
      : initial_(make(ParameterWatch::valuesOf(*node->get_node_parameters_interface(), names))),
        newest_(std::make_shared<LatestValue<Gains>>(initial_)),
        watch_(
            *node, names, [make](const ParameterValues& values) { make(values); },
            [make, newest = newest_](const ParameterValues& values) {
              newest->back() = make(values);
              newest->publish();
            }) {}

  const Gains& initial() const noexcept { return initial_; }

  /// The newest gains if they have changed since the last call, else null. Real time: no
  /// allocation, lock, exception or system call.
  const Gains* changed() noexcept { return newest_->take(); }

 private:
  Gains initial_;
  std::shared_ptr<LatestValue<Gains>> newest_;  // a change that is being applied keeps it
  ParameterWatch watch_;
};

}  // namespace inverse_dynamics_controllers
