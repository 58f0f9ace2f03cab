// SPDX-License-Identifier: Apache-2.0
/// @file
/// A chain, or the tree of a robot description, as Pinocchio's model.
#pragma once

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

/// The model of a chain: joint i is Pinocchio's joint i + 1, with its axis along z. A continuous
/// joint is a revolute one, so that positions stay angles (nq = nv). The last frame is the tip's.
Model toPinocchio(const chain_dynamics::Chain& chain);

/// The model of a whole tree, for tests and benchmarks of trees: all joints that move, parents first,
/// by their names, whatever they mimic; a frame for each link, by its name. Gravity is zero.
Model toPinocchio(const chain_dynamics::RobotDescription& robot);

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver
