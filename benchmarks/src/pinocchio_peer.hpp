// SPDX-License-Identifier: Apache-2.0

/// @file
/// Pinocchio's fastest calls, timed on the same states.
#pragma once

#include <string>

namespace inverse_dynamics_benchmarks {

/// Registers the benchmarks `ROBOT/QUANTITY/pinocchio`.
void registerPinocchio(const std::string& robot, const std::string& urdf);

}  // namespace inverse_dynamics_benchmarks
