// SPDX-License-Identifier: Apache-2.0

/// @file
/// The robot of a node's parameters: a run configuration by the parameter `robot`, and parameters that
/// take precedence over it.
///
/// They replace its fields, as the options of `ids evaluate` do.

#pragma once

#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <memory>
#include <rclcpp/node.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

/// Namespace of a solver's parameters in a node.
inline const std::string kSolverNamespace = "ids";

/// Declares robot_parameters.yaml, and what the user gives below `ids.`: which parameters a solver
/// has, only it knows.
void declareRobotParameters(rclcpp::Node& node);

/// Parameters that are set from outside (launch file, command line), without defaults.
///
/// @param prefix  selects names, and is removed from them: `retime.`.
/// @throws inverse_dynamics_solver::InvalidParameterValueException: byte arrays.
inverse_dynamics_solver::Parameters givenParameters(rclcpp::Node& node,
                                                    const std::string& prefix = "");

/// The robot of a node's parameters.
class NodeRobot {
 public:
  /// Parameters: robot, plugin_name, robot_description, joints, effort, drive_gains, accelerations,
  /// cutoff, and the solver's below `ids.`.
  ///
  /// @param given  only what the user has set: a default would replace the run configuration's.
  /// @throws inverse_dynamics_evaluation::ConfigurationError: what readRunConfiguration() says.
  /// @throws inverse_dynamics_solver::InvalidParameterValueException: one of another type.
  explicit NodeRobot(const inverse_dynamics_solver::Parameters& given);

  /// With the changes; without the parameter `robot` its name and file are empty.
  const inverse_dynamics_evaluation::RunConfiguration& configuration() const {
    return configuration_;
  }

  /// Text of a URDF: the parameter's, else that of the run configuration's file; empty: none.
  ///
  /// @throws UserError: a file that can't be read.
  std::string description() const;

  /// A solver, initialized with the parameters and a description.
  ///
  /// @param description  text of a URDF; empty: none.
  /// @throws UserError: no plugin name.
  /// @throws inverse_dynamics_solver::Exception: what the loader and the solver say; a parameter
  /// below `ids.` that the solver doesn't know.
  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> makeSolver(
      const std::string& description) const;

  /// Name of the run configuration, else of the description's robot; empty: not known.
  std::string name(const std::string& description) const;

  /// Names of the first and the last link of the chain: as stated, else the description's root and
  /// its only leaf; empty: not known.
  ///
  /// @param tips  tipNames() of the solver: of a tree the first is meant.
  std::string rootLink(const std::string& description) const;
  std::string tipLink(const std::string& description,
                      const std::vector<std::string>& tips = {}) const;

 private:
  std::string statedLink(const std::string& parameter) const;

  inverse_dynamics_evaluation::RunConfiguration configuration_;
  std::string description_;                                // the parameter
  inverse_dynamics_solver::Parameters solver_parameters_;  // below kSolverNamespace
};

/// Unit of each joint's torque: N for a prismatic joint, else N m.
std::vector<std::string> torqueUnits(const inverse_dynamics_solver::InverseDynamicsSolver& solver);

}  // namespace inverse_dynamics_ros
