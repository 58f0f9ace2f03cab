// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law's gains, from two parameters that may change while the loop runs.
///
///     ChangingGains<PdGains> gains(node, {"gains.p", "gains.d"}, make);
///     PdGravityCompensation law(solver, gains.initial(), options);
///     if (const PdGains* changed = gains.changed()) law.setGains(*changed);    // in each cycle
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "latest_value.hpp"
#include "parameter_watch.hpp"

namespace inverse_dynamics_controllers {

/// @tparam Gains  of the law; numbers of joints.
template <class Gains>
class ChangingGains {
 public:
  /// Gains of the numbers of both parameters. Throws: they don't fit.
  using Make = std::function<Gains(const std::vector<double>&, const std::vector<double>&)>;

  /// Throws what `make` throws.
  ChangingGains(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                const std::array<std::string, 2>& names, const Make& make)
      : ChangingGains(node, names, [make, names](const ParameterValues& values) {
          using Numbers = std::vector<double>;
          return make(values.at(names[0]).template get<Numbers>(),
                      values.at(names[1]).template get<Numbers>());
        }) {}

  const Gains& initial() const noexcept { return initial_; }

  /// The newest gains if they have changed since the last call, else null. Real time: no
  /// allocation, lock, exception or system call.
  const Gains* changed() noexcept { return newest_->take(); }

 private:
  using MakeOfValues = std::function<Gains(const ParameterValues&)>;

  ChangingGains(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                const std::array<std::string, 2>& names, const MakeOfValues& make)
      : initial_(make(valuesOf(*node->get_node_parameters_interface(), {names[0], names[1]}))),
        newest_(std::make_shared<LatestValue<Gains>>(initial_)),
        watch_(
            node, {names[0], names[1]}, [make](const ParameterValues& values) { make(values); },
            [make, newest = newest_](const ParameterValues& values) {
              newest->back() = make(values);
              newest->publish();
            }) {}

  Gains initial_;
  std::shared_ptr<LatestValue<Gains>> newest_;  // a change that is being applied keeps it
  ParameterWatch watch_;
};

}  // namespace inverse_dynamics_controllers
