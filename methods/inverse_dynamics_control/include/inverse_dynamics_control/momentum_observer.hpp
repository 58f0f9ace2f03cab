// SPDX-License-Identifier: Apache-2.0
/// @file
/// External torques from the generalised momentum p = H(q) qd.
///
///     MomentumObserver observer(solver, options);
///     observer.update(state, effort, period);
///
/// Momentum changes by what acts, `dp/dt = tau - tau_ext - g - f + C^T qd`, and the observer
///
///     r = K (integral of (tau + C^T qd - g - f - r) dt - p)
///
/// follows tau_ext as `dr/dt = K (tau_ext - r)`, without an acceleration [De Luca and Mattone, ICRA
/// 2003; Haddadin, De Luca and Albu-Schaeffer, T-RO 33(6), 2017, sec. IV-E].
///
/// Here the integral of one period is taken with `dH/dt = C + C^T`: the part of it that isn't known
/// from `C qd` is the change of H, and the two values of H are there anyway,
///
///     change of p - integral of C^T qd  =  mean H  (change of qd)  +  T mean (C qd),
///
/// to the second order of the period T. So no matrix C is needed, and nothing is summed up that
/// could drift.
#pragma once

#include <chain_dynamics/owned.hpp>
#include <memory>

#include "inverse_dynamics_control/external_torque_estimator.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Momentum observer; see the head of this file.
class MomentumObserver : public ExternalTorqueEstimator {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: a solver whose
  /// inertiaIsPhysical() is false; options of the wrong size or value. UninitializedException: the
  /// solver isn't initialized.
  MomentumObserver(std::shared_ptr<const InverseDynamicsSolver> solver,
                   const EstimatorOptions& options);

 protected:
  void begin(const OwnedVector& q, const OwnedVector& qd) override;
  void meanTorques(const OwnedVector& q0, const OwnedVector& qd0, const OwnedVector& q1,
                   const OwnedVector& qd1, double period, VectorRef bias,
                   VectorRef inertial) override;

 private:
  void terms(const OwnedVector& q, const OwnedVector& qd);

  chain_dynamics::OwnedMatrix H0_, H_;   // of the last and the present sample
  OwnedVector bias0_, bias_, friction_;  // C qd + g + f
  OwnedVector change_;                   // of velocity, scratch
};

}  // namespace v2
}  // namespace inverse_dynamics_control
