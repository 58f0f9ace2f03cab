// SPDX-License-Identifier: Apache-2.0

/// @file
/// Computed and measured torques as a recording, in messages like those that were read.

#pragma once

#include <string>

#include "evaluation.hpp"
#include "recorded_motion.hpp"

namespace inverse_dynamics_ros {

/// Writes `topic` (computed) and `topic`_gt (measured, if efforts were recorded).
///
/// Messages are of the joints of the chain, with their stamps, header's and reception's, kept; only
/// their efforts are others. Whole or not at all.
///
/// @throws UserError: the target exists or can't be written; Interrupted.
void writeTorques(const std::string& target, inverse_dynamics_evaluation::Storage storage,
                  const std::string& topic, const RecordedMotion& motion,
                  const Evaluation& evaluation);

}  // namespace inverse_dynamics_ros
