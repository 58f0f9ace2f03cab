// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the controllers have in common when they are configured: solver, joints, limits, options.
///
///     const ArmParameters parameters = armParameters(listener->get_params());
///     Arm arm = makeArm(node, parameters, robotDescriptionOf(*this));
///     LawOptions options = lawOptions(arm, parameters, get_update_rate());
#pragma once

#include <inverse_dynamics_control/control_law.hpp>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <vector>

#include "urdf_limits.hpp"

namespace inverse_dynamics_controllers {

/// The parameters that all controllers have; see their descriptions.
struct ArmParameters {
  std::string plugin_name, robot_description;
  std::vector<std::string> joints;
  double robot_description_timeout = 0.0;
  inverse_dynamics_control::Compensated compensated;
  std::string friction_source;
  inverse_dynamics_control::FrictionOptions friction;  // but for its source
  std::vector<double> effort, effort_rate;
  std::vector<double> damping, damping_posture;
  double damping_rate = 0.0, period = 0.0;
};

/// The same from the struct that generate_parameter_library has made for a controller.
template <class Params>
ArmParameters armParameters(const Params& params) {
  ArmParameters arm;
  arm.plugin_name = params.plugin_name;
  arm.robot_description = params.robot_description;
  arm.joints = params.joints;
  arm.robot_description_timeout = params.robot_description_timeout;
  arm.compensated = {params.compensated_by_robot.gravity, params.compensated_by_robot.coriolis,
                     params.compensated_by_robot.friction};
  arm.friction_source = params.friction.source;
  arm.friction.dead_band = params.friction.dead_band;
  arm.friction.blend = params.friction.blend;
  arm.friction.scale = params.friction.scale;
  arm.effort = params.limits.effort;
  arm.effort_rate = params.limits.effort_rate;
  arm.damping = params.damping.values;
  arm.damping_posture = params.damping.posture;
  arm.damping_rate = params.damping.rate;
  arm.period = params.period;
  return arm;
}

/// A robot arm as its controller knows it.
struct Arm {
  std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver;
  std::vector<std::string> joints;  ///< names of the hardware, in the order of the chain
  UrdfLimits limits;
};

/// Loads and initializes the solver, with the node's parameters below `ids`.
///
/// @param managers_description  robot description that the controller manager has given, or "".
/// Throws inverse_dynamics_solver::Exception: no such plugin, what the solver says, other joints.
Arm makeArm(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
            const ArmParameters& parameters, const std::string& managers_description);

/// Options of the law.
///
/// @param update_rate  of the controller [Hz]; 0: not known.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: wrong size or value.
/// ParameterUninitializedException: no limit of effort; no period where one is needed.
inverse_dynamics_control::LawOptions lawOptions(const Arm& arm, const ArmParameters& parameters,
                                                unsigned update_rate);

/// Limits of references: the parameters', where they are empty those of the robot description.
template <class LimitParams>
inverse_dynamics_control::ReferenceLimits referenceLimits(const Arm& arm,
                                                          const LimitParams& params);

}  // namespace inverse_dynamics_controllers

#include "joint_numbers.hpp"

template <class LimitParams>
inverse_dynamics_control::ReferenceLimits inverse_dynamics_controllers::referenceLimits(
    const Arm& arm, const LimitParams& params) {
  const inverse_dynamics_control::ReferenceLimits& urdf = arm.limits.reference;
  return {jointNumbers("limits.position_lower", params.position_lower, arm.joints, urdf.lower),
          jointNumbers("limits.position_upper", params.position_upper, arm.joints, urdf.upper),
          jointNumbers("limits.velocity", params.velocity, arm.joints, urdf.velocity)};
}
