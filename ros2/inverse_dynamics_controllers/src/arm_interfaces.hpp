// SPDX-License-Identifier: Apache-2.0
/// @file
/// A controller's interfaces to the hardware, a position, a velocity and an effort per joint.
#pragma once

#include <Eigen/Core>
#include <controller_interface/controller_interface_base.hpp>
#include <cstddef>
#include <hardware_interface/loaned_command_interface.hpp>
#include <hardware_interface/loaned_state_interface.hpp>
#include <inverse_dynamics_control/signals.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using CommandInterfaces = std::vector<hardware_interface::LoanedCommandInterface>;
using StateInterfaces = std::vector<hardware_interface::LoanedStateInterface>;

/// Finds, reads and writes the interfaces of an arm's joints.
class ArmInterfaces {
 public:
  /// @param joints    of the states.
  /// @param commands  full names of the command interfaces, as many; none: efforts are measured.
  explicit ArmInterfaces(std::vector<std::string> joints, std::vector<std::string> commands = {});

  const std::vector<std::string>& joints() const noexcept { return joints_; }

  /// `joint/position`, `joint/velocity` and, where it is measured, `joint/effort` of all joints.
  controller_interface::InterfaceConfiguration states() const;

  controller_interface::InterfaceConfiguration commands() const;

  /// Finds the interfaces among those loaned, whatever their order.
  ///
  /// Throws inverse_dynamics_solver::Exception: one is missing.
  void bind(const StateInterfaces& states, const CommandInterfaces& commands);

  /// Measured state; NaN where a value can't be read. Real time: no allocation, exception or system
  /// call.
  ///
  /// @param[out] state  of n joints.
  void read(const StateInterfaces& states,
            inverse_dynamics_control::JointState& state) const noexcept;

  /// Measured efforts [N m]; NaN where a value can't be read. Real time: as read().
  ///
  /// @param[out] effort  n.
  void readEffort(const StateInterfaces& states, Eigen::VectorXd& effort) const noexcept;

  /// Commands the efforts [N m]. Real time: as read().
  ///
  /// @return false: one couldn't be written and keeps its value.
  bool write(const Eigen::VectorXd& tau, CommandInterfaces& commands) const noexcept;

 private:
  std::vector<std::string> joints_, commands_;
  std::vector<std::size_t> positions_, velocities_, efforts_;  // where they are
};

}  // namespace inverse_dynamics_controllers
