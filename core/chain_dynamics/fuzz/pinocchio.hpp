// SPDX-License-Identifier: Apache-2.0

/// @file
/// Torques of a robot description as Pinocchio reads it: pinocchio_torques.cpp, in another process.

#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "equal_kernels.hpp"

namespace chain_dynamics::fuzz {

/// Torques of these joints, all others at rest at zero.
///
/// The program is that of the environment variable CHAIN_DYNAMICS_PINOCCHIO. Nothing where there is
/// none, and where it refuses the description, crashes, or takes more than 5 s.
std::optional<Eigen::VectorXd> pinocchioTorques(const std::string& urdf,
                                                const std::vector<std::string>& joints,
                                                const State& state);

}  // namespace chain_dynamics::fuzz
