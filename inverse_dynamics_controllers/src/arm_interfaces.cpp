// SPDX-License-Identifier: Apache-2.0
#include "arm_interfaces.hpp"

#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <utility>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace inverse_dynamics_controllers {
namespace {

using hardware_interface::HW_IF_EFFORT;
using hardware_interface::HW_IF_POSITION;
using hardware_interface::HW_IF_VELOCITY;

template <class Interfaces>
std::size_t find(const Interfaces& interfaces, const std::string& name, const char* kind) {
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    if (interfaces[i].get_name() == name) return i;
  }
  throw inverse_dynamics_solver::Exception(inverse_dynamics_solver::errorText(
      kind, "missing", name, std::to_string(interfaces.size()) + " others",
      "let the hardware component export it (<ros2_control> of the robot description), or correct "
      "the parameter 'joints'"));
}

}  // namespace

ArmInterfaces::ArmInterfaces(std::vector<std::string> joints) : joints_(std::move(joints)) {}

controller_interface::InterfaceConfiguration ArmInterfaces::states() const {
  controller_interface::InterfaceConfiguration configuration;
  configuration.type = controller_interface::interface_configuration_type::INDIVIDUAL;
  for (const std::string& joint : joints_) {
    configuration.names.push_back(joint + "/" + HW_IF_POSITION);
    configuration.names.push_back(joint + "/" + HW_IF_VELOCITY);
  }
  return configuration;
}

controller_interface::InterfaceConfiguration ArmInterfaces::commands() const {
  controller_interface::InterfaceConfiguration configuration;
  configuration.type = controller_interface::interface_configuration_type::INDIVIDUAL;
  for (const std::string& joint : joints_) {
    configuration.names.push_back(joint + "/" + HW_IF_EFFORT);
  }
  return configuration;
}

void ArmInterfaces::bind(const StateInterfaces& states, const CommandInterfaces& commands) {
  positions_.clear();
  velocities_.clear();
  efforts_.clear();
  for (const std::string& joint : joints_) {
    positions_.push_back(find(states, joint + "/" + HW_IF_POSITION, "state interface"));
    velocities_.push_back(find(states, joint + "/" + HW_IF_VELOCITY, "state interface"));
    efforts_.push_back(find(commands, joint + "/" + HW_IF_EFFORT, "command interface"));
  }
}

void ArmInterfaces::read(const StateInterfaces& states,
                         inverse_dynamics_control::JointState& state) const noexcept {
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    state.q[row] = valueOf(states[positions_[j]]);
    state.qd[row] = valueOf(states[velocities_[j]]);
  }
}

bool ArmInterfaces::write(const Eigen::VectorXd& tau, CommandInterfaces& commands) const noexcept {
  bool written = true;
  for (std::size_t j = 0; j < efforts_.size(); ++j) {
    written = setValue(commands[efforts_[j]], tau[static_cast<Eigen::Index>(j)]) && written;
  }
  return written;
}

}  // namespace inverse_dynamics_controllers
