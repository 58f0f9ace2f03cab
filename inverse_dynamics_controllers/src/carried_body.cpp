// SPDX-License-Identifier: Apache-2.0
#include "carried_body.hpp"

#include <chrono>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using geometry_msgs::msg::InertiaStamped;
using inverse_dynamics_control::PayloadRamp;
using inverse_dynamics_solver::RigidBody;

namespace {

constexpr std::chrono::milliseconds kStep(10);

std::vector<std::string> parameterNames() {
  return {"payload.mass", "payload.center_of_mass", "payload.inertia"};
}

RigidBody bodyOfParameters(const ParameterValues& values) {
  return inverse_dynamics_control::bodyOf(
      values.at("payload.mass").get<double>(),
      values.at("payload.center_of_mass").get<std::vector<double>>(),
      values.at("payload.inertia").get<std::vector<double>>(), "parameter payload.");
}

}  // namespace

CarriedBody::CarriedBody(const Setup& setup) {
  const RigidBody first =
      bodyOfParameters(valuesOf(*setup.node->get_node_parameters_interface(), parameterNames()));
  ramp_ =
      std::make_shared<PayloadRamp>(setup.arm.solver, first, setup.parameters.payload.ramp_time);

  const auto check = [ramp = ramp_](const ParameterValues& values) {
    ramp->requireCarrier(bodyOfParameters(values));
  };
  const auto apply = [ramp = ramp_](const ParameterValues& values) {
    ramp->aimAt(bodyOfParameters(values));
  };
  watch_ = std::make_unique<ParameterWatch>(setup.node, parameterNames(), check, apply);

  const auto receive = [ramp = ramp_, tip = setup.tip(),
                        logger = setup.node->get_logger()](const InertiaStamped& message) {
    try {
      ramp->aimAt(inverse_dynamics_control::bodyOf(message, tip));
    } catch (const std::exception& error) {
      RCLCPP_ERROR(logger, "~/payload: ignored: %s", error.what());
    }
  };
  subscription_ = setup.node->create_subscription<InertiaStamped>(
      "~/payload", rclcpp::SystemDefaultsQoS(), receive);
  timer_ = setup.node->create_wall_timer(
      kStep, [ramp = ramp_] { ramp->advance(std::chrono::duration<double>(kStep).count()); });
}

}  // namespace inverse_dynamics_controllers
