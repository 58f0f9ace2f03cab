// SPDX-License-Identifier: Apache-2.0

/// @file
/// From recorded joint states to computed torques and their errors.
///
///     Evaluation evaluation = evaluate(log, *solver, options);
///     std::cout << evaluation.errors[0].rmse << " N m\n" << evaluation.table->computed.col(0);
///
/// A recording of any length is read once, into a table that may exceed the memory:
///
///     const auto source = Recording("motion").jointStates();   // inverse_dynamics_evaluation
///     RecordingOptions recording;
///     recording.joints = solver->jointNames();
///     recording.scratch = "result";   // a directory with room for the table
///     Evaluation evaluation = evaluate(*source, recording, *solver, options);
///
/// The steps, in the order in which they are taken; docs/evaluation.md has the formulas. readMotion() takes 1 and 2,
/// computeTorques() 3, compareTorques() 4 and 5, evaluate() all of them:
///
/// 1. The stated meaning of efforts (effort.hpp).
/// 2. Faults of the samples (samples.hpp), and accelerations (accelerations.hpp).
/// 3. Torques by the solver.
/// 4. The meaning of efforts by the caller's comparison with the data, where `auto` is stated.
/// 5. Errors of the computed against the measured torques (metrics.hpp): over all samples, and over
///    those that were kept. Findings and notes say the same in words.

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/effort.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Options of an evaluation, and names for its texts.
struct EvaluationOptions {
  AccelerationMethod method = AccelerationMethod::kAuto;
  double cutoff = 0;               ///< Hz; of the low-pass; 0: chosen from the data
  SampleRules rules;               ///< faults of samples to act on
  EffortOptions effort;            ///< stated meaning of efforts
  std::string recording;           ///< its file or directory
  std::string topic;               ///< in it; empty: it has none
  std::vector<std::string> units;  ///< n; of the torques: N m or N; empty: texts leave them out
  std::vector<std::string> notes;  ///< what was left out or assumed in reading: SampleTable::notes
  TellProgress progress;
  /// The model whose gravity the robot subtracts from its efforts; null: the solver's.
  const inverse_dynamics_solver::InverseDynamicsSolver* subtracted = nullptr;
};

/// Result of an evaluation. Copies share the table.
struct Evaluation {
  std::vector<std::string> joint_names;  ///< n; those of the solver
  /// Samples, accelerations and flags of each sample; measured torques, and computed ones, without
  /// gravity if the efforts are.
  std::shared_ptr<SampleTable> table;
  AccelerationReport accelerations;  ///< their origin, and findings; the table flags each sample
  Effort effort;                     ///< kAutomatic until compareTorques() settles it
  /// n; over all samples, or, if some are of a second source, over those that were kept; empty without efforts.
  std::vector<JointMetrics> errors;
  std::vector<JointMetrics> errors_of_kept;  ///< n; over those that were kept
  std::vector<std::string> notes;  ///< of solver and recording, on efforts, on the samples
};

/// A recorded motion: its samples, their faults and accelerations; no torques yet.
///
/// @param columns  without efforts there will be computed torques, but no errors.
/// @throws EvaluationError: samples that can't be evaluated. @throws ConfigurationError: currents without drive gains.
Evaluation readMotion(const RecordedColumns& columns,
                      const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                      const EvaluationOptions& options);

/// The same of a recording, which is read once.
///
/// @throws RecordingError: as readTable() does.
Evaluation readMotion(JointStateSource& source, const RecordingOptions& recording,
                      const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                      const EvaluationOptions& options);

/// Torques of a motion, with gravity.
///
/// @throws EvaluationError: torques that no robot has.
void computeTorques(Evaluation& motion,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options);

/// Measured torques and errors of a motion whose torques are computed.
///
/// @param verdict  what the data say efforts mean; counts where `auto` is stated. Without one: torques.
void compareTorques(Evaluation& motion,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const EffortVerdict& verdict = {});

/// Torques of a recorded motion against the measured ones: all steps. Throws what they do.
Evaluation evaluate(const RecordedColumns& columns,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options);

/// The same for a recording, which is read once.
Evaluation evaluate(JointStateSource& source, const RecordingOptions& recording,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options);

/// Refuses options that fit no recording.
///
/// @throws EvaluationError: a cut-off that no filter has, or for a method that has none; no such
///         meaning of efforts. @throws ConfigurationError: currents without drive gains.
void checkOptions(const EvaluationOptions& options);

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
