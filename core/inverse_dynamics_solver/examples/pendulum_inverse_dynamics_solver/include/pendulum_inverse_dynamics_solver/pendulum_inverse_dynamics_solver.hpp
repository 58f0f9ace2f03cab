// SPDX-License-Identifier: Apache-2.0
/// @file
/// The smallest complete solver: a point mass on a rod that swings about the y axis and hangs down
/// at q = 0.
///
///     solver->initialize({{"mass", 2.0}, {"length", 0.5}});   // also: damping, gravity, friction
#pragma once

#include "inverse_dynamics_solver/energies.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace pendulum_inverse_dynamics_solver {

using inverse_dynamics_solver::Configuration;
using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;

/// `tau = m l^2 qdd + d qd + m l (gx cos q - gz sin q)`.
class InverseDynamicsSolverPendulum : public inverse_dynamics_solver::InverseDynamicsSolver,
                                      public inverse_dynamics_solver::Energies {
 protected:
  JointInfo configure(const Configuration& configuration) override;
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override;
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override;
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override;
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override;
  bool inertiaIsPhysicalImpl() const override { return true; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  double computeKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const override;
  double computePotentialEnergy(const ConstVectorRef& q) const override;

 private:
  double mass_ = 0.0;     // kg
  double length_ = 0.0;   // m
  double damping_ = 0.0;  // N m s/rad
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
};

}  // namespace pendulum_inverse_dynamics_solver
