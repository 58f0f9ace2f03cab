// SPDX-License-Identifier: Apache-2.0

/// @file
/// This library's solvers, through the public interface, into the caller's memory.
#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>

namespace inverse_dynamics_benchmarks {

/// Benchmarks `ROBOT/QUANTITY/ours`, one state a call: torques, inertia, coriolis, gravity,
/// components.
void registerSingleCalls(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmark `ROBOT/friction/ours`.
void registerFriction(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmarks `ROBOT/QUANTITY/ours`, all states a call: torques_batch, inertia_batch, ...
void registerBatches(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmark `ROBOT/torques_rows/ours`: row-major, so that a state's numbers stand far apart.
void registerRows(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmark `ROBOT/torques_many/LIBRARY`: 131072 states, enough to be shared among
/// threads; in real time.
void registerManyStates(
    const std::string& robot, const std::string& library,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmarks `ROBOT/torques_memory/ours`, a batch that no cache holds, and
/// `ROBOT/torques_memory/sum`, the sum of the same three arrays: what the memory allows.
void registerLargeBatch(
    const std::string& robot,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Benchmark of torques alone, by its whole name.
void registerTorques(
    const std::string& name,
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver);

/// Torques with a body at the tip that was set after initialize(), and setting it and gravity.
void registerPayload(const std::string& robot,
                     const std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver>& solver);

}  // namespace inverse_dynamics_benchmarks
