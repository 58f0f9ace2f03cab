// SPDX-License-Identifier: Apache-2.0

/// @file
/// The evaluation of `ids evaluate`, with its series in memory, and its table.
///
///     Evaluation evaluation = evaluate(motion.log, *solver, options);
///     std::cout << errorTable(evaluation, units);

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_ros {

using inverse_dynamics_evaluation::EvaluationOptions;

/// Computed and measured torques of N samples of n joints, one sample per column; N m (prismatic N).
struct Evaluation : inverse_dynamics_evaluation::Evaluation {
  Eigen::MatrixXd computed;  ///< n x N; without gravity where the efforts are
  Eigen::MatrixXd measured;  ///< n x N; empty (0 x 0) where no efforts are recorded
};

/// @throws inverse_dynamics_evaluation::EvaluationError: samples that can't be evaluated.
/// @throws inverse_dynamics_evaluation::ConfigurationError: currents without drive gains.
Evaluation evaluate(const inverse_dynamics_evaluation::JointLog& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options);

/// Errors of each joint as a table of text, as `ids evaluate` prints it.
///
/// @param units  one per joint.
std::string errorTable(const Evaluation& evaluation, const std::vector<std::string>& units);

}  // namespace inverse_dynamics_ros
