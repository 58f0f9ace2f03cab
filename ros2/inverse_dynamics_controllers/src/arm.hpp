// SPDX-License-Identifier: Apache-2.0
/// @file
/// Configuration that all controllers share: solver, joints, limits, options.
#pragma once

#include <inverse_dynamics_control/control_law.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_controllers/arm_parameters.hpp>
#include <inverse_dynamics_controllers/law_parameters.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

#include "robot_description.hpp"

namespace inverse_dynamics_controllers {

/// The parameters that all controllers have; see their descriptions.
using ArmParameters = arm_parameters::Params;

/// The parameters that controllers with commands have in addition.
using LawParameters = law_parameters::Params;

/// A robot arm as its controller knows it.
struct Arm {
  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver;
  std::vector<std::string> joints;    ///< names of the hardware, in the order of the chain
  std::vector<std::string> commands;  ///< full names of the command interfaces, in the same order
  inverse_dynamics_control::DescribedLimits limits;
};

/// Inputs of a controller's configuration.
struct Setup {
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node;
  ArmParameters parameters;
  LawParameters law;  ///< the defaults where nothing is commanded
  Arm arm;
  double period;      ///< of the control loop [s]
  bool has_fallback;  ///< whether the manager starts other controllers when this one fails

  /// The solver's tip, the first of several; empty: its name isn't known.
  std::string tip() const;
};

/// Where a controller's robot comes from: parameters, and the robot description.
class ArmSource {
 public:
  enum class Use { kCommand, kMeasure };

  /// Declares the parameters, those of laws only for kCommand, and what is given below `ids.`;
  /// listens for the robot description. Throws what is wrong with a parameter.
  ArmSource(std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node, Use use);

  /// Loads and initializes the solver, with the node's parameters below `ids`. Waits for nothing.
  ///
  /// @param managers_description  robot description that the controller manager has given, or "".
  /// @param update_rate           of the controller [Hz]; 0: not known (humble).
  /// Throws inverse_dynamics_solver::Exception: a parameter that the controller doesn't declare, no
  /// such plugin, what the solver says, other joints, a period that isn't that of the update rate.
  Setup setup(const std::string& managers_description, unsigned update_rate) const;

 private:
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_;
  std::shared_ptr<void> suggesting_;  // suggests names for misspelt parameters
  std::shared_ptr<arm_parameters::ParamListener> parameters_;
  std::shared_ptr<law_parameters::ParamListener> law_;  // null: nothing is commanded
  RobotDescriptionTopic description_;
};

/// The parameters `compensated_by_robot.*`.
inverse_dynamics_control::Compensated compensatedByRobot(const Setup& setup);

/// Options of the law.
///
/// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value.
/// ParameterUninitializedException: no limit of effort.
inverse_dynamics_control::LawOptions lawOptions(const Setup& setup,
                                                const std::string& friction_source);

}  // namespace inverse_dynamics_controllers
