// SPDX-License-Identifier: Apache-2.0
/// @file
/// External torques as measured minus computed torques, for solvers of any kind.
///
///     AccelerationResidual residual(solver, options);
///     residual.update(state, effort, period);
///
/// The acceleration is the change of velocity over a period, and what is left of the torque is
/// low-passed,
///
///     dr/dt = K (tau - H(q) qdd - C(q, qd) qd - g(q) - f(qd) - r),
///
/// with the solver's terms in the middle of the period. It asks nothing of H: identified models,
/// whose H is often neither symmetric nor positive definite, say what torque belongs to a motion,
/// and that is all that is used. Where H is physical, it gives what the MomentumObserver gives, to
/// the second order of the period.
#pragma once

#include <chain_dynamics/owned.hpp>
#include <memory>

#include "inverse_dynamics_control/external_torque_estimator.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Residual of inverse dynamics; see the head of this file.
class AccelerationResidual : public ExternalTorqueEstimator {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: options of the wrong size or
  /// value. UninitializedException: the solver isn't initialized.
  AccelerationResidual(std::shared_ptr<const InverseDynamicsSolver> solver,
                       const EstimatorOptions& options);

 protected:
  void begin(const OwnedVector& q, const OwnedVector& qd) override;
  void meanTorques(const OwnedVector& q0, const OwnedVector& qd0, const OwnedVector& q1,
                   const OwnedVector& qd1, double period, VectorRef bias,
                   VectorRef inertial) override;

 private:
  chain_dynamics::OwnedMatrix H_;        // in the middle of the period
  OwnedVector q_, qd_, qdd_, friction_;  // there
};

}  // namespace v2
}  // namespace inverse_dynamics_control
