// SPDX-License-Identifier: Apache-2.0
#include "arm_interfaces.hpp"

#include <cstddef>
#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <initializer_list>
#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace inverse_dynamics_controllers {
namespace {

using hardware_interface::HW_IF_EFFORT;
using hardware_interface::HW_IF_POSITION;
using hardware_interface::HW_IF_VELOCITY;

constexpr auto kIndividual = controller_interface::interface_configuration_type::INDIVIDUAL;
const char* const kState = "state interface";

// `joint/interface`, joint by joint.
std::vector<std::string> namesOf(const std::vector<std::string>& joints,
                                 std::initializer_list<const char*> interfaces) {
  std::vector<std::string> names;
  for (const std::string& joint : joints) {
    for (const char* interface : interfaces) names.push_back(joint + "/" + interface);
  }
  return names;
}

template <class Interfaces>
std::size_t find(const Interfaces& interfaces, const std::string& name, const char* kind) {
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    if (interfaces[i].get_name() == name) return i;
  }
  throw inverse_dynamics_solver::Exception(
      kind, "missing", name, std::to_string(interfaces.size()) + " others",
      "let the hardware component export it (<ros2_control> of the robot description), or correct "
      "the parameters 'joints', 'command_joints' and 'command_interface'");
}

template <class Interfaces>
std::vector<std::size_t> find(const Interfaces& interfaces, const std::vector<std::string>& names,
                              const char* kind) {
  std::vector<std::size_t> places;
  places.reserve(names.size());
  for (const std::string& name : names) places.push_back(find(interfaces, name, kind));
  return places;
}

}  // namespace

ArmInterfaces::ArmInterfaces(std::vector<std::string> joints, std::vector<std::string> commands)
    : joints_(std::move(joints)), commands_(std::move(commands)) {}

controller_interface::InterfaceConfiguration ArmInterfaces::states() const {
  if (!commands_.empty()) return {kIndividual, namesOf(joints_, {HW_IF_POSITION, HW_IF_VELOCITY})};
  return {kIndividual, namesOf(joints_, {HW_IF_POSITION, HW_IF_VELOCITY, HW_IF_EFFORT})};
}

controller_interface::InterfaceConfiguration ArmInterfaces::commands() const {
  return {kIndividual, commands_};
}

void ArmInterfaces::bind(const StateInterfaces& states, const CommandInterfaces& commands) {
  positions_ = find(states, namesOf(joints_, {HW_IF_POSITION}), kState);
  velocities_ = find(states, namesOf(joints_, {HW_IF_VELOCITY}), kState);
  efforts_ = commands_.empty() ? find(states, namesOf(joints_, {HW_IF_EFFORT}), kState)
                               : find(commands, commands_, "command interface");
}

void ArmInterfaces::read(const StateInterfaces& states,
                         inverse_dynamics_control::JointState& state) const noexcept {
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    state.q[row] = valueOf(states[positions_[j]]);
    state.qd[row] = valueOf(states[velocities_[j]]);
  }
}

void ArmInterfaces::readEffort(const StateInterfaces& states,
                               Eigen::VectorXd& effort) const noexcept {
  for (std::size_t j = 0; j < efforts_.size(); ++j) {
    effort[static_cast<Eigen::Index>(j)] = valueOf(states[efforts_[j]]);
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
