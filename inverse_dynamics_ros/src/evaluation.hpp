// SPDX-License-Identifier: Apache-2.0

/// @file
/// From samples to computed torques and their errors: the steps of `ids evaluate`, by the same
/// functions.
///
///     Evaluation evaluation = evaluate(motion.log, *solver, options);
///     std::cout << errorTable(evaluation, units);

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_evaluation/log_accelerations.hpp>
#include <inverse_dynamics_evaluation/metrics.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

#include "effort_meaning.hpp"

namespace inverse_dynamics_ros {

/// How accelerations are estimated, and what efforts mean.
struct EvaluationOptions {
  inverse_dynamics_evaluation::AccelerationMethod method =
      inverse_dynamics_evaluation::AccelerationMethod::kAuto;
  double cutoff = 0;  ///< Hz; 0: chosen from the data
  inverse_dynamics_evaluation::SampleRules rules;
  EffortMeaning effort;
};

/// Computed and measured torques of N samples of n joints, a sample a column; N m (prismatic N).
struct Evaluation {
  std::vector<std::string> joint_names;  ///< those of the solver
  inverse_dynamics_evaluation::LogAccelerations accelerations;
  Eigen::MatrixXd computed;  ///< n x N; without gravity where the efforts are
  Eigen::MatrixXd measured;  ///< n x N; empty (0 x 0) where no efforts are recorded
  /// Over all samples, and over those that count; empty where no efforts are recorded.
  std::vector<inverse_dynamics_evaluation::JointMetrics> errors, errors_of_kept;
};

/// @throws inverse_dynamics_evaluation::EvaluationError: samples that can't be evaluated.
Evaluation evaluate(const inverse_dynamics_evaluation::JointLog& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options);

/// The rules but those named: `repeated`, `non-increasing`, `time-base`, `start-transient`.
///
/// @throws UserError: another name.
inverse_dynamics_evaluation::SampleRules rulesWithout(const std::vector<std::string>& names);

/// Errors of each joint as a table of text, as `ids evaluate` prints it.
///
/// @param units  one per joint.
std::string errorTable(const Evaluation& evaluation, const std::vector<std::string>& units);

}  // namespace inverse_dynamics_ros
