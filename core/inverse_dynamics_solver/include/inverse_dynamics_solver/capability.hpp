// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capabilities that only some solvers have: small classes besides InverseDynamicsSolver, found by dynamic_cast.
///
///     if (const auto* kinematics = dynamic_cast<const Kinematics*>(solver.get())) {
///       Eigen::MatrixXd J = kinematics->getTipJacobian(q);
///     }
///
/// | header                  | class              | quantities                                     |
/// |-------------------------|--------------------|------------------------------------------------|
/// | kinematics.hpp          | Kinematics         | pose of the tip, Jacobian and its derivative   |
/// | external_wrench.hpp     | ExternalWrench     | torques of a wrench at the tip                 |
/// | coriolis_matrix.hpp     | CoriolisMatrix     | `C(q, qd)`                                     |
/// | energies.hpp            | Energies           | kinetic and potential energy                   |
/// | torque_derivatives.hpp  | TorqueDerivatives  | derivatives of the torques                     |
/// | regressor.hpp           | Regressor          | torques as linear in the inertial parameters   |
/// | forward_dynamics.hpp    | ForwardDynamics    | accelerations of given torques                 |
/// | payload.hpp             | Payload            | bodies at the tip that come and go             |
/// | variable_gravity.hpp    | VariableGravity    | gravity and an accelerating base               |
/// | load_friction.hpp       | LoadFriction       | whether friction depends on the position       |
/// | friction_memory.hpp     | FrictionMemory     | friction after the motion so far               |
/// | motor_currents.hpp      | MotorCurrents      | currents of the motors                         |
/// | torque_deviation.hpp    | TorqueDeviation    | how far measured torques are from the model's  |
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Base of the capabilities; not of InverseDynamicsSolver: a solver derives from it and from the
/// capabilities it has.
///
/// As in InverseDynamicsSolver, public methods aren't virtual: they check, then call a protected
/// virtual `compute...`. Every quantity comes by value, into memory of the caller, and for many
/// states at once (`...Batch`: one state per column); joints, units, errors (uninitialized, wrong
/// size), and the promises about NaN, real time and threads are those of InverseDynamicsSolver.
/// Destructors are out of line, so that there is one type information for dynamic_cast across
/// plugin libraries.
class Capability {
 public:
  virtual ~Capability();

 protected:
  Capability() = default;
  Capability(const Capability&) = default;
  Capability& operator=(const Capability&) = default;

  /// The solver that has the capability: `return *this;`. One override serves all capabilities of a
  /// class.
  virtual const InverseDynamicsSolver& torqueSolver() const = 0;

  /// Number of joints, for results by value.
  ///
  /// @throws UninitializedException  naming the method.
  Eigen::Index jointsFor(const char* method) const;

  /// Index of a tip among InverseDynamicsSolver::tipNames().
  ///
  /// @throws UninitializedException, InvalidParameterValueException (no such tip)  naming the method.
  std::size_t tipIndex(const char* method, const std::string& tip) const;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
