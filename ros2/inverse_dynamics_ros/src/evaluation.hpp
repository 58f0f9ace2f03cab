// SPDX-License-Identifier: Apache-2.0

/// @file
/// The table of `ids evaluate`.

#pragma once

#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

using inverse_dynamics_evaluation::evaluate;
using inverse_dynamics_evaluation::Evaluation;
using inverse_dynamics_evaluation::EvaluationOptions;

/// Errors of each joint as a table of text, as `ids evaluate` prints it.
///
/// @param units  one per joint.
std::string errorTable(const Evaluation& evaluation, const std::vector<std::string>& units);

}  // namespace inverse_dynamics_ros
