// SPDX-License-Identifier: Apache-2.0
/// @file
/// A chain of the engine as a chain of KDL: both solvers read robot descriptions the same way.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/frames.hpp>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/spatial.hpp"

namespace kdl_inverse_dynamics_solver {
inline namespace v2 {

/// The same joints, links and rotor inertias; segment i of the result ends in frame i of the chain.
KDL::Chain toKdl(const chain_dynamics::Chain& chain);

/// A pose.
KDL::Frame toKdl(const chain_dynamics::Transform<double>& pose);

/// Gravity of the chain, in its root frame [m/s^2].
KDL::Vector toKdl(const Eigen::Vector3d& vector);

}  // namespace v2
}  // namespace kdl_inverse_dynamics_solver
