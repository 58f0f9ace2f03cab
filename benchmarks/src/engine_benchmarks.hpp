// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the engine computes and no solver offers.
#pragma once

#include <chain_dynamics/chain.hpp>
#include <string>

namespace inverse_dynamics_benchmarks {

/// Forward dynamics, regressor, derivatives of torques, Coriolis matrix, the tip's pose, Jacobian and
/// its derivative, ROBOT/QUANTITY/ours, of one state a call and (QUANTITY_batch) of 64; Gram matrices
/// of the regressor, of 64.
void registerEngine(const std::string& robot, const chain_dynamics::Chain& chain);

}  // namespace inverse_dynamics_benchmarks
