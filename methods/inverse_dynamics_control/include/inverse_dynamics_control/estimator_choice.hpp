// SPDX-License-Identifier: Apache-2.0
/// @file
/// The estimator of external torques that a solver allows.
///
///     const auto estimator = estimatorFor(solver, options);
///     if (estimator->update(state, effort, period) == EstimateStatus::kOk) use(estimator->torques());
#pragma once

#include <memory>

#include "inverse_dynamics_control/external_torque_estimator.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// kAutomatic: a MomentumObserver where the solver's `inertiaIsPhysical()`, else an
/// AccelerationResidual.
enum class Estimator { kAutomatic, kMomentum, kAccelerationResidual };

/// @param solver  initialized; it is kept.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: no solver; options of the wrong
/// size or value. UninitializedException: the solver isn't initialized. Allocates.
std::unique_ptr<ExternalTorqueEstimator> estimatorFor(
    std::shared_ptr<const InverseDynamicsSolver> solver, const EstimatorOptions& options,
    Estimator choice = Estimator::kAutomatic);

}  // namespace v2
}  // namespace inverse_dynamics_control
