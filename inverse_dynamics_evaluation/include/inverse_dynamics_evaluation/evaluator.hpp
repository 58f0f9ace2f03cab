// SPDX-License-Identifier: Apache-2.0

/// @file
/// From recorded joint states to computed torques and their errors.
///
///     Evaluation evaluation = evaluate(log, *solver, options, [&](const EvaluatedSamples& next) {
///       bag.write(next.stamps, next.q, next.qd, next.computed);
///     });
///     std::cout << evaluation.errors[0].rmse << " N m\n";
///
/// The steps, in the order in which they are taken; docs/evaluation.md has the formulas:
///
/// 1. What efforts mean, as it is stated (effort.hpp).
/// 2. Faults of the samples (samples.hpp), and accelerations (log_accelerations.hpp).
/// 3. Torques by the solver, block by block.
/// 4. What efforts mean by the data, if they are to tell (effort_verdict.hpp).
/// 5. Errors of the computed against the measured torques (metrics.hpp): over all samples, and over
///    those that were kept.
///
/// All of it is said in words too: findings and notes, a sentence each.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/effort.hpp"
#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/log_accelerations.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// How a recording is to be evaluated, and how texts name it.
struct EvaluationOptions {
  AccelerationMethod method = AccelerationMethod::kAuto;
  double cutoff = 0;               ///< Hz; of the low-pass; 0: chosen from the data
  SampleRules rules;               ///< which faults of samples are acted upon
  EffortOptions effort;            ///< what is stated of efforts
  std::string recording;           ///< its file or directory
  std::string topic;               ///< in it; empty: it has none
  std::vector<std::string> units;  ///< n; of the torques: N m or N; empty: texts leave them out
  std::vector<std::string> notes;  ///< what was left out or assumed in reading: JointLog::notes
};

/// Some samples of a result: n x N, a sample a column, valid during a call.
struct EvaluatedSamples {
  using Block = Eigen::Ref<const Eigen::MatrixXd>;

  Eigen::Index first;  ///< number of the first of them in the recording
  Block q, qd, qdd;    ///< rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2)
  Block computed;      ///< N m (prismatic N); without gravity where the efforts are
  Block measured;      ///< N m (prismatic N): what efforts mean; empty if none was recorded
};

/// Takes the next samples of a result.
using TakeSamples = std::function<void(const EvaluatedSamples&)>;

/// What came of an evaluation, but for the series that went to TakeSamples.
struct Evaluation {
  std::vector<std::string> joint_names;  ///< n; those of the solver
  LogAccelerations accelerations;        ///< and what was found in the samples
  Effort effort;
  std::vector<JointMetrics> errors;          ///< n; over all samples; empty without efforts
  std::vector<JointMetrics> errors_of_kept;  ///< n; over accelerations.samples.kept
  std::vector<std::string> notes;   ///< of solver and recording, on efforts, on the samples
  double acceleration_seconds = 0;  ///< how long step 2 took
  double torque_seconds = 0;        ///< how long steps 3 to 5 took
};

/// Torques of a recorded motion against the measured ones.
///
/// @param log   without efforts there are computed torques, but no errors.
/// @param take  gets all samples, in their order; none: nobody needs them.
/// @throws EvaluationError: samples that can't be evaluated; torques that no robot has.
/// @throws ConfigurationError: currents without drive gains.
Evaluation evaluate(const JointLogView& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const TakeSamples& take = nullptr);

/// All rules but those named: `repeated`, `non-increasing`, `time-base`, `start-transient`.
///
/// @throws EvaluationError: another name.
SampleRules rulesWithout(const std::vector<std::string>& names);

/// Refuses torques that no robot has: infinite, NaN, above kLargestNumber.
///
/// @param where  what was computed, for the text.
/// @param units  n, or none.
/// @param first  number of the first sample, counted from 0.
/// @throws EvaluationError: names the sample and the joint.
void requirePossibleTorques(const std::string& where, const std::vector<std::string>& joint_names,
                            const std::vector<std::string>& units,
                            const Eigen::Ref<const Eigen::MatrixXd>& computed, Eigen::Index first);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
