// SPDX-License-Identifier: Apache-2.0

/// @file
/// From recorded joint states to computed torques and their errors.
///
///     Evaluation evaluation = evaluate(log, *solver, options, [&](const EvaluatedSamples& next) {
///       table.append(next.time, next.computed);
///     });
///     std::cout << evaluation.errors[0].rmse << " N m\n";
///
/// A recording of any length is read from its file, several times, in bounded memory:
///
///     const auto source = Recording("motion").jointStates();   // inverse_dynamics_recordings
///     RecordingOptions recording;
///     recording.joints = solver->jointNames();
///     Evaluation evaluation = evaluate(*source, recording, *solver, options);
///
/// The steps, in the order in which they are taken; docs/evaluation.md has the formulas:
///
/// 1. What efforts mean, as it is stated (effort.hpp).
/// 2. Faults of the samples (samples.hpp), and accelerations (log_accelerations.hpp).
/// 3. Torques by the solver, block by block.
/// 4. What efforts mean by the data, if they are to tell (effort_verdict.hpp).
/// 5. Errors of the computed against the measured torques (metrics.hpp): over all samples, and over
///    those that were kept. Findings and notes say the same in words.

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/effort.hpp"
#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/log_accelerations.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"
#include "inverse_dynamics_evaluation/time_window.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Told what share of the work is done, 0 to 1; what it throws ends the evaluation.
using TellProgress = std::function<void(double)>;

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
  TellProgress progress;           ///< none: nobody is told
};

/// Which joints of a recording, and which time.
struct RecordingOptions {
  std::vector<std::string> joints;  ///< n; their names there, in the order of the chain
  Clock clock = Clock::kAuto;
  JointLogOptions log;
  std::string scratch;  ///< directory for an unnamed file that keeps the samples of the first
                        ///< pass, 192 bytes each with seven joints; empty: the source is read again
  TimeSpan window = {};  ///< the others aren't evaluated
};

/// Some samples of a result: n x B, one sample per column, valid during a call.
struct EvaluatedSamples {
  using Block = Eigen::Ref<const Eigen::MatrixXd>;
  using Stamps = Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;
  using Flags = Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>;

  Eigen::Index first;                      ///< number of the first of them in the recording
  Eigen::Index all;                        ///< N; how many the recording has
  Stamps header_stamps, receive_stamps;    ///< B; ns
  Eigen::Ref<const Eigen::VectorXd> time;  ///< B; s since the first sample
  Block q, qd, qdd;                        ///< rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2)
  Block effort;                            ///< as recorded; empty if none was
  Block computed;  ///< N m (prismatic N); without gravity where the efforts are
  Block measured;  ///< N m (prismatic N): what efforts mean; empty if none was recorded
  Flags repeated, non_increasing, start_transient, isolated, kept;  ///< B; as in SampleReport
  const std::string& frame_id;  ///< the first that a header has, of a recording that was read here
};

/// Takes the next samples of a result.
using TakeSamples = std::function<void(const EvaluatedSamples&)>;

/// What came of an evaluation, but for the series that went to TakeSamples.
struct Evaluation {
  std::vector<std::string> joint_names;  ///< n; those of the solver
  LogAccelerations accelerations;        ///< and what was found in the samples
  Effort effort;
  std::vector<JointMetrics> errors;          ///< n; over all samples; empty without efforts
  std::vector<JointMetrics> errors_of_kept;  ///< n; over those that were kept
  std::vector<std::string> notes;  ///< of solver and recording, on efforts, on the samples
  JointLog recording;              ///< names, clock, frame, notes of a recording that was read here
  double reading_seconds = 0;      ///< how long reading took, all passes together
  double acceleration_seconds = 0;  ///< how long step 2 took
  double torque_seconds = 0;        ///< how long steps 3 to 5 took
};

/// Torques of a recorded motion against the measured ones.
///
/// @param log   without efforts there are computed torques, but no errors.
/// @param take  gets all samples, in their order, 4096 at a time; none: nobody needs them.
/// @throws EvaluationError: samples that can't be evaluated; torques that no robot has.
/// @throws ConfigurationError: currents without drive gains.
Evaluation evaluate(const JointLogView& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const TakeSamples& take = nullptr);

/// The same of a recording that needn't fit into memory: three to five passes over it.
///
/// What the report has a number for each sample for, and accelerations, go to `take` alone.
///
/// @throws RecordingError: by the rules of joint_log.hpp; another pass gives other samples; they
///         don't fit into the scratch directory.
Evaluation evaluate(JointStateSource& source, const RecordingOptions& recording,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const TakeSamples& take = nullptr);

/// What is wrong with options whatever the recording is.
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
