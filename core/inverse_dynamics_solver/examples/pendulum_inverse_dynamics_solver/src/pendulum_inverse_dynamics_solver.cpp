// SPDX-License-Identifier: Apache-2.0
#include "pendulum_inverse_dynamics_solver/pendulum_inverse_dynamics_solver.hpp"

#include <cmath>
#include <string>

namespace pendulum_inverse_dynamics_solver {

using inverse_dynamics_solver::InvalidParameterValueException;

auto InverseDynamicsSolverPendulum::configure(const Configuration& configuration) -> JointInfo {
  // Read and check; whatever throws here leaves the solver as it was.
  const auto mass = configuration.require<double>("mass");
  const auto length = configuration.require<double>("length");
  const double damping = configuration.get<double>("damping").value_or(0.0);
  if (!(mass > 0.0) || !(length > 0.0)) {
    throw InvalidParameterValueException(
        configuration.fullName("mass") + ", " + configuration.fullName("length"), "wrong value",
        "positive numbers [kg, m]", std::to_string(mass) + ", " + std::to_string(length));
  }
  configuration.rejectOthers();
  JointInfo info;
  info.joint_names = {"pivot"};

  // Keep; nothing below can throw.
  mass_ = mass;
  length_ = length;
  damping_ = configuration.friction ? damping : 0.0;
  gravity_ = configuration.gravity;
  return info;
}

void InverseDynamicsSolverPendulum::computeInertiaMatrix(const ConstVectorRef&, MatrixRef H) const {
  H(0, 0) = mass_ * length_ * length_;
}

void InverseDynamicsSolverPendulum::computeCoriolisVector(const ConstVectorRef&,
                                                          const ConstVectorRef&,
                                                          VectorRef c) const {
  c[0] = 0.0;
}

void InverseDynamicsSolverPendulum::computeGravityVector(const ConstVectorRef& q,
                                                         VectorRef g) const {
  g[0] = mass_ * length_ * (gravity_.x() * std::cos(q[0]) - gravity_.z() * std::sin(q[0]));
}

void InverseDynamicsSolverPendulum::computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                                                    VectorRef f) const {
  f[0] = damping_ * qd[0];
}

double InverseDynamicsSolverPendulum::computeKineticEnergy(const ConstVectorRef&,
                                                           const ConstVectorRef& qd) const {
  return 0.5 * mass_ * length_ * length_ * qd[0] * qd[0];
}

double InverseDynamicsSolverPendulum::computePotentialEnergy(const ConstVectorRef& q) const {
  return mass_ * length_ * (gravity_.x() * std::sin(q[0]) + gravity_.z() * std::cos(q[0]));
}

}  // namespace pendulum_inverse_dynamics_solver
