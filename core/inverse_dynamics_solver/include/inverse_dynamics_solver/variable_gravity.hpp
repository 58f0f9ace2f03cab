// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot may stand on something that tilts or accelerates: a vehicle, a
/// mount that is turned, another robot.
///
///     if (auto* arm = dynamic_cast<VariableGravity*>(solver.get())) {
///       arm->setGravity(R_root_world * Eigen::Vector3d(0, 0, -9.81));   // from tf
///       arm->setBaseAcceleration(a);                                    // from the vehicle
///     }
#pragma once

#include <Eigen/Core>
#include <functional>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Gravity and the linear acceleration of the robot's base, both in the axes of the root link
/// [m/s^2], changed while control loops compute.
///
/// An accelerating base is the same as gravity less its acceleration, so getGravityVector() holds
/// both. What an accelerometer on the base shows, turned into the axes of the root link, is the
/// acceleration less gravity: `setGravity(-reading)`, with an acceleration of zero, is all of it. A
/// base that **rotates** is not covered: its angular velocity and acceleration act on the links in
/// other ways.
///
/// Threads and real time: as setPayload() [payload.hpp]. initialize() makes gravity that of its
/// parameters, or of the model, and the acceleration zero.
///
/// Errors: UninitializedException before a successful initialize(); InvalidParameterValueException
/// for a number that isn't finite or beyond 1e6: nothing has changed.
class VariableGravity : public Capability {
 public:
  ~VariableGravity() override;

  /// Where things fall; (0, 0, -9.81) for a robot that stands upright on Earth.
  void setGravity(const Eigen::Vector3d& gravity);

  /// How the root link accelerates relative to the ground.
  void setBaseAcceleration(const Eigen::Vector3d& acceleration);

  Eigen::Vector3d gravity() const;
  Eigen::Vector3d baseAcceleration() const;

 protected:
  /// Apparent gravity of the root link.
  struct BaseMotion {
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();

    /// Gravity less acceleration, on which the dynamics depend.
    Eigen::Vector3d apparentGravity() const { return gravity - acceleration; }
  };

  /// @name What a solver implements
  /// @{

  /// Computes with what `change` makes of the current ones, from the next call on; all or nothing,
  /// by one thread at a time.
  virtual void changeBaseMotion(const std::function<void(BaseMotion&)>& change) = 0;

  virtual BaseMotion currentBaseMotion() const = 0;
  /// @}

 private:
  BaseMotion required(const char* method) const;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
