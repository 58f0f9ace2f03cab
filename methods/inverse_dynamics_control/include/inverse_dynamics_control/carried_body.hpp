// SPDX-License-Identifier: Apache-2.0
/// @file
/// The body that the arm of a ROS node carries: parameters `payload.*`, topic `~/payload`.
///
/// A template that takes ROS types from the node, so that no ROS header is needed here.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_control/parameter_watch.hpp"
#include "inverse_dynamics_control/payload_ramp.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Gives a solver the body that the parameters `payload.*` or the topic `~/payload` say last.
///
/// A change takes `payload.ramp_time` of the node's clock, in steps of 10 ms of its executor. An
/// impossible body is refused with a reason, and changes nothing.
///
/// Threads: all methods may be called while the node's executor runs.
///
/// @tparam Node            rclcpp::Node or rclcpp_lifecycle::LifecycleNode.
/// @tparam InertiaStamped  geometry_msgs::msg::InertiaStamped.
template <class Node, class InertiaStamped>
class CarriedBody {
 public:
  /// Writes an error into the log.
  using Log = std::function<void(const std::string&)>;

  /// @param node         has declared the parameters.
  /// @param qos,options  of the subscription.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: the parameters make no possible
  /// body.
  template <class Qos, class Options>
  CarriedBody(Node& node, const Qos& qos, const Options& options, Log log)
      : state_(std::make_shared<State>(std::move(log))),
        ramp_time_(node.get_parameter("payload.ramp_time").as_double()),
        watch_(
            node, names(),
            [state = state_](const Values& values) { state->requireCarrier(bodyOfValues(values)); },
            [state = state_](const Values& values) {
              state->take("payload", [&] { return bodyOfValues(values); });
            }) {
    state_->body = bodyOfValues(Watch::valuesOf(*node.get_node_parameters_interface(), names()));
    subscription_ = node.template create_subscription<InertiaStamped>(
        "~/payload", qos,
        [state = state_](const InertiaStamped& message) {
          state->take("~/payload", [&] { return bodyOf(message, state->tipLink()); });
        },
        options);
    state_->last = node.get_clock()->now().nanoseconds();
    timer_ = node.create_wall_timer(kStep, [state = state_, clock = node.get_clock()] {
      state->advanceTo(clock->now().nanoseconds());
    });
  }

  /// A ramp that begins with what is carried now. Throws what PayloadRamp throws.
  std::shared_ptr<PayloadRamp> rampOf(std::shared_ptr<InverseDynamicsSolver> solver) const {
    return std::make_shared<PayloadRamp>(std::move(solver), body(), ramp_time_);
  }

  /// Loads the solver of this ramp from now on. @param tip  name of its link; empty: not known.
  void use(std::shared_ptr<PayloadRamp> ramp, std::string tip) {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->ramp = std::move(ramp);
    state_->tip = std::move(tip);
  }

  /// The body that is carried once the ramp has ended.
  RigidBody body() const {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    return state_->body;
  }

 private:
  using Watch = ParameterWatch<Node>;
  using Values = typename Watch::Values;
  static constexpr std::chrono::milliseconds kStep{10};

  // Running callbacks keep it alive.
  struct State {
    explicit State(Log given) : log(std::move(given)) {}

    const Log log;
    std::mutex mutex;
    RigidBody body;                     // what was asked for last
    std::shared_ptr<PayloadRamp> ramp;  // null until there is a solver
    std::string tip;
    std::int64_t last = 0;  // time of the node's clock, ns

    std::string tipLink() {
      const std::lock_guard<std::mutex> lock(mutex);
      return tip;
    }
    void requireCarrier(const RigidBody& wanted) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (ramp != nullptr) ramp->requireCarrier(wanted);
    }
    template <class Make>
    void take(const std::string& from, const Make& make) {
      try {
        const RigidBody wanted = make();
        const std::lock_guard<std::mutex> lock(mutex);
        if (ramp != nullptr) ramp->aimAt(wanted);
        body = wanted;
      } catch (const std::exception& error) {
        log(from + ": ignored: " + error.what());
      }
    }
    // Torques don't jump when the clock does.
    void advanceTo(std::int64_t now) {
      const std::lock_guard<std::mutex> lock(mutex);
      const double seconds = 1e-9 * static_cast<double>(now - std::exchange(last, now));
      if (ramp != nullptr) ramp->advance(std::clamp(seconds, 0.0, 0.1));
    }
  };

  static std::vector<std::string> names() {
    return {"payload.mass", "payload.center_of_mass", "payload.inertia"};
  }

  static RigidBody bodyOfValues(const Values& values) {
    using Numbers = std::vector<double>;
    return bodyOf(values.at("payload.mass").template get<double>(),
                  values.at("payload.center_of_mass").template get<Numbers>(),
                  values.at("payload.inertia").template get<Numbers>(), "parameter payload.");
  }

  std::shared_ptr<State> state_;
  double ramp_time_;  // s
  Watch watch_;
  std::shared_ptr<void> subscription_, timer_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control
