// SPDX-License-Identifier: Apache-2.0

/// @file
/// Estimators of external torques, one update a call.
#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>

namespace inverse_dynamics_benchmarks {

/// Benchmark `ROBOT/acceleration_residual/ours` and, where the solver's H is physical,
/// `ROBOT/momentum_observer/ours`: an update with velocities from positions, friction included.
void registerObservers(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

}  // namespace inverse_dynamics_benchmarks
