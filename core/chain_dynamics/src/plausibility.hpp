// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers of a robot description that a rigid body can have, but hardly has: wrong units, a digit
/// too many, a body that was forgotten.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/robot_description.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A sentence for each link whose inertia is implausible, or missing.
///
/// A radius of gyration is implausible if it exceeds half the length of the stretched chain: that of
/// a rod as long as the chain with all its mass at the two ends. Inertia is missing where a moving
/// link has no `<inertial>`, although it is a body between two joints, and a link beyond it has mass.
///
/// @param parts  links of the description that each joint of the chain moves, the joint's own child
///               first.
std::vector<std::string> inertiaDoubts(const RobotDescription& robot, const Chain& chain,
                                       const std::vector<std::vector<std::size_t>>& parts);

/// A sentence for a joint whose effort limit is below its gravity torque in every posture looked at, and
/// for each whose limits are probably in degrees.
std::vector<std::string> limitDoubts(const Chain& chain);

/// A sentence if a joint's limits exclude a position; empty if they don't.
std::string positionDoubt(const RobotDescription::Joint& joint, double position);

}  // namespace v2
}  // namespace chain_dynamics
