// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: how the robot moves under given torques.
///
///     if (const auto* forward = dynamic_cast<const ForwardDynamics*>(solver.get())) {
///       Eigen::VectorXd qdd = forward->getAccelerations(q, qd, tau);
///     }
#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The inverse of getTorques(), friction included unless it is switched off.
///
/// Where H isn't that of rigid bodies, the result would be no motion of the robot: all methods throw
/// Exception where inertiaIsPhysical() is false.
class ForwardDynamics : public Capability {
 public:
  ~ForwardDynamics() override;

  /// `qdd = H(q)^-1 (tau - C(q, qd) qd - f(q, qd) - g(q))`, n [rad/s^2; prismatic m/s^2].
  Eigen::VectorXd getAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                   const ConstVectorRef& tau) const {
    Eigen::VectorXd qdd(jointsFor("getAccelerations"));
    getAccelerations(q, qd, tau, qdd);
    return qdd;
  }
  void getAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                        const ConstVectorRef& tau, VectorRef qdd) const;

  /// n x N.
  Eigen::MatrixXd getAccelerationsBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                        const ConstStatesRef& tau) const {
    Eigen::MatrixXd qdd(q.joints, q.count);
    getAccelerationsBatch(q, qd, tau, qdd);
    return qdd;
  }
  void getAccelerationsBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                             const ConstStatesRef& tau, const States& qdd) const;

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver, called where inertiaIsPhysical() is true; a batch by
  /// default one state after the other.
  /// @{
  virtual void computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    const ConstVectorRef& tau, VectorRef qdd) const = 0;
  virtual void computeAccelerationsBatch(const ConstStates& q, const ConstStates& qd,
                                         const ConstStates& tau, const States& qdd) const;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver
