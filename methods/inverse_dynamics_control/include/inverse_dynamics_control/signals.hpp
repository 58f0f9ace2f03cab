// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inputs of a law: the measured state and the desired motion, one number per joint.
///
///     JointState state(solver->jointCount());       // once, before the control loop
///     state.q[0] = position_interface.get_value();  // in each cycle: no allocation
///
/// They own their memory, so that no call copies an expression into a temporary.
#pragma once

#include <Eigen/Core>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

using chain_dynamics::OwnedVector;

/// Measured state of n joints, in the order of the solver's jointNames().
struct JointState {
  /// At rest in q = 0.
  explicit JointState(Eigen::Index joints)
      : q(Eigen::VectorXd::Zero(joints)), qd(Eigen::VectorXd::Zero(joints)) {}

  OwnedVector q;   ///< n; rad (prismatic m)
  OwnedVector qd;  ///< n; rad/s (prismatic m/s)
};

/// Desired motion of n joints, in the order of the solver's jointNames().
struct Reference {
  /// At rest in q = 0.
  explicit Reference(Eigen::Index joints)
      : q(Eigen::VectorXd::Zero(joints)),
        qd(Eigen::VectorXd::Zero(joints)),
        qdd(Eigen::VectorXd::Zero(joints)) {}

  OwnedVector q;    ///< n; rad (prismatic m)
  OwnedVector qd;   ///< n; rad/s (prismatic m/s)
  OwnedVector qdd;  ///< n; rad/s^2 (prismatic m/s^2)
};

}  // namespace v2
}  // namespace inverse_dynamics_control
