// SPDX-License-Identifier: Apache-2.0
#include "simulated_arm.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <exception>
#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/logging.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace inverse_dynamics_simulation {

using chain_dynamics::joined;
using hardware_interface::CallbackReturn;
using hardware_interface::HW_IF_ACCELERATION;
using hardware_interface::HW_IF_EFFORT;
using hardware_interface::HW_IF_POSITION;
using hardware_interface::HW_IF_VELOCITY;
using hardware_interface::return_type;

namespace {

rclcpp::Logger logger() { return rclcpp::get_logger("simulated_arm"); }

double number(const std::string& where, const std::string& unit, const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::logic_error&) {  // no number at all
  }
  if (used > 0 && used == text.size() && std::isfinite(value)) return value;
  throw std::invalid_argument(where + ": expected a number [" + unit + "], got '" + text + "'");
}

// Where a joint is at first: `initial_value` of its position.
double initialPosition(const hardware_interface::ComponentInfo& joint) {
  for (const hardware_interface::InterfaceInfo& state : joint.state_interfaces) {
    if (state.name != HW_IF_POSITION || state.initial_value.empty()) continue;
    return number("joint " + joint.name + ": initial_value of position", "rad",
                  state.initial_value);
  }
  return 0.0;
}

// Of the parameters `payload` and `payload_link`.
Payload payloadOf(const hardware_interface::HardwareInfo& info) {
  const auto& parameters = info.hardware_parameters;
  const auto mass = parameters.find("payload"), link = parameters.find("payload_link");
  if (mass == parameters.end()) return {};
  Payload payload{link == parameters.end() ? "" : link->second,
                  number("parameter payload", "kg", mass->second)};
  if (payload.mass >= 0) return payload;
  throw std::invalid_argument("parameter payload: expected a mass [kg], got '" + mass->second +
                              "'");
}

void requireEffort(const hardware_interface::ComponentInfo& joint) {
  if (joint.command_interfaces.size() == 1 && joint.command_interfaces[0].name == HW_IF_EFFORT) {
    return;
  }
  std::vector<std::string> names;
  names.reserve(joint.command_interfaces.size());
  for (const auto& command : joint.command_interfaces) names.push_back(command.name);
  throw std::invalid_argument("joint " + joint.name +
                              ": command_interface: expected effort alone, got " +
                              (names.empty() ? "none" : joined(names)));
}

}  // namespace

#ifdef INVERSE_DYNAMICS_SIMULATION_HAS_COMPONENT_PARAMS
CallbackReturn SimulatedArm::on_init(
    const hardware_interface::HardwareComponentInterfaceParams& params) {
  const CallbackReturn base = SystemInterface::on_init(params);
  return base == CallbackReturn::SUCCESS ? initialize(params.hardware_info) : base;
}
#else
CallbackReturn SimulatedArm::on_init(const hardware_interface::HardwareInfo& info) {
  const CallbackReturn base = SystemInterface::on_init(info);
  return base == CallbackReturn::SUCCESS ? initialize(info) : base;
}
#endif

CallbackReturn SimulatedArm::initialize(const hardware_interface::HardwareInfo& info) {
  try {
    std::vector<std::string> names;
    for (const hardware_interface::ComponentInfo& joint : info.joints) {
      requireEffort(joint);
      names.push_back(joint.name);
      joints_.push_back({joint.name, initialPosition(joint)});
    }
    arm_ = std::make_unique<MujocoArm>(info.original_xml, names, payloadOf(info));
  } catch (const std::exception& error) {
    RCLCPP_FATAL(logger(), "%s: %s", info.name.c_str(), error.what());
    return CallbackReturn::ERROR;
  }
  tau_.setZero(static_cast<Eigen::Index>(joints_.size()));
  Eigen::VectorXd q(tau_.size());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = joints_[static_cast<std::size_t>(j)].position;
  arm_->setPosition(q);
  return CallbackReturn::SUCCESS;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // from jazzy on, but still there
std::vector<hardware_interface::StateInterface> SimulatedArm::export_state_interfaces() {
  std::vector<hardware_interface::StateInterface> interfaces;
  for (Joint& joint : joints_) {
    interfaces.emplace_back(joint.name, HW_IF_POSITION, &joint.position);
    interfaces.emplace_back(joint.name, HW_IF_VELOCITY, &joint.velocity);
    interfaces.emplace_back(joint.name, HW_IF_ACCELERATION, &joint.acceleration);
    interfaces.emplace_back(joint.name, HW_IF_EFFORT, &joint.effort);
  }
  return interfaces;
}

std::vector<hardware_interface::CommandInterface> SimulatedArm::export_command_interfaces() {
  std::vector<hardware_interface::CommandInterface> interfaces;
  interfaces.reserve(joints_.size());
  for (Joint& joint : joints_) interfaces.emplace_back(joint.name, HW_IF_EFFORT, &joint.command);
  return interfaces;
}
#pragma GCC diagnostic pop

CallbackReturn SimulatedArm::on_activate(const rclcpp_lifecycle::State&) {
  for (Joint& joint : joints_) joint.command = 0.0;
  return CallbackReturn::SUCCESS;
}

return_type SimulatedArm::perform_command_mode_switch(const std::vector<std::string>& start,
                                                      const std::vector<std::string>& stop) {
  const auto has = [](const std::vector<std::string>& keys, const std::string& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  const bool was_braked = isBraked();
  for (Joint& joint : joints_) {
    const std::string key = joint.name + "/" + HW_IF_EFFORT;
    joint.claimed = has(start, key) || (joint.claimed && !has(stop, key));
  }
  if (isBraked() && !was_braked) {
    tau_.setZero();
    arm_->setPosition(arm_->q());
  }
  return return_type::OK;
}

bool SimulatedArm::isBraked() const {
  return std::none_of(joints_.begin(), joints_.end(),
                      [](const Joint& joint) { return joint.claimed; });
}

return_type SimulatedArm::read(const rclcpp::Time&, const rclcpp::Duration&) {
  const bool braked = isBraked();
  const Eigen::VectorXd q = arm_->q(), qd = arm_->qd(), qdd = arm_->qdd();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    joints_[j].position = q[row];
    joints_[j].velocity = qd[row];
    joints_[j].acceleration = braked ? 0.0 : qdd[row];
    joints_[j].effort = tau_[row];
  }
  return return_type::OK;
}

return_type SimulatedArm::write(const rclcpp::Time&, const rclcpp::Duration& period) {
  if (isBraked()) return return_type::OK;
  for (const Joint& joint : joints_) {
    if (!std::isfinite(joint.command)) {
      RCLCPP_ERROR(logger(), "joint %s: an effort of NaN or infinity was commanded",
                   joint.name.c_str());
      return return_type::ERROR;
    }
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    tau_[static_cast<Eigen::Index>(j)] = joints_[j].command;
  }
  arm_->step(tau_, period.seconds());
  return return_type::OK;
}

}  // namespace inverse_dynamics_simulation

PLUGINLIB_EXPORT_CLASS(inverse_dynamics_simulation::SimulatedArm,
                       hardware_interface::SystemInterface)
