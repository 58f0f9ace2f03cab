// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot arm in MuJoCo, from its URDF, with exactly the inertia that the URDF states.
///
/// MuJoCo knows nothing of the solvers: it checks controllers independently. What it would do to a
/// URDF on its own is undone: inertia that breaks the triangle inequality is balanced while it
/// compiles and written back; `<dynamics>` isn't taken for damping; no contacts, no forces at
/// position limits.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

namespace inverse_dynamics_simulation {

/// A point mass at the origin of a link's frame.
struct Payload {
  std::string link;
  double mass = 0.0;  // kg; 0: none
};

/// Rigid bodies under given torques, integrated by a fourth-order Runge-Kutta method. Not
/// thread-safe.
class MujocoArm {
 public:
  /// @param urdf     with shapes, without meshes; other movable joints than `joints` are free.
  /// @param joints   n names of revolute or prismatic joints.
  /// @param payload  what the arm carries beside what the URDF says.
  /// Throws inverse_dynamics_solver::InvalidRobotDescriptionException: MuJoCo refuses the URDF, no
  /// such joint or link.
  MujocoArm(const std::string& urdf, const std::vector<std::string>& joints,
            const Payload& payload = {});

  /// Rest at q, n; rad.
  void setPosition(const Eigen::VectorXd& q);

  /// Goes on for `period` [s] under constant torques, in steps of at most 1 ms.
  ///
  /// @param tau  n; N m.
  void step(const Eigen::VectorXd& tau, double period);

  /// State, and acceleration of the last step: n; rad, rad/s, rad/s^2.
  Eigen::VectorXd q() const;
  Eigen::VectorXd qd() const;
  Eigen::VectorXd qdd() const;

 private:
  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
  std::vector<int> positions_, velocities_;  // of the joints, in MuJoCo's vectors
};

}  // namespace inverse_dynamics_simulation
