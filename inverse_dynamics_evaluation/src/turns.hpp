// SPDX-License-Identifier: Apache-2.0

/// @file
/// Recorded positions without the seams that drivers make who report within one turn.

#pragma once

#include <chain_dynamics/chain.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Makes positions of continuous joints go on where they jump by a turn from one sample to the next.
///
/// Such jumps of revolute joints stay as they are. Nothing changes if there are other joints than
/// types: that is refused elsewhere.
///
/// @param joint_names  for the texts.
/// @return a sentence for each revolute joint that jumps.
std::vector<std::string> unwrapPositions(SampleTable& table,
                                         const std::vector<chain_dynamics::JointType>& types,
                                         const std::vector<std::string>& joint_names);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
