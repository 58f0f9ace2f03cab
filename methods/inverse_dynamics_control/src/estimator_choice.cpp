// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/estimator_choice.hpp"

#include <memory>
#include <utility>

#include "inverse_dynamics_control/acceleration_residual.hpp"
#include "inverse_dynamics_control/momentum_observer.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

std::unique_ptr<ExternalTorqueEstimator> estimatorFor(
    std::shared_ptr<const InverseDynamicsSolver> solver, const EstimatorOptions& options,
    Estimator choice) {
  if (choice == Estimator::kMomentum ||
      (choice == Estimator::kAutomatic && solver != nullptr && solver->inertiaIsPhysical())) {
    return std::make_unique<MomentumObserver>(std::move(solver), options);
  }
  return std::make_unique<AccelerationResidual>(std::move(solver), options);
}

}  // namespace v2
}  // namespace inverse_dynamics_control
