// SPDX-License-Identifier: Apache-2.0

/// @file
/// Accelerations of a JointLog, by the method a user names, and in words how they came about.
///
///     LogAccelerations found = logAccelerations(log, accelerationMethod("auto"));
///     std::cout << found.summary << "\n";   // zero-phase low-pass, cut-off 1.72 Hz (chosen ...
///     for (const std::string& sentence : found.findings) std::cout << sentence << "\n";

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What an evaluation needs of a JointLog, looked at where it lies.
struct JointLogView {
  using Block = Eigen::Ref<const Eigen::MatrixXd>;
  using StampsBlock = Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;

  StampsBlock header_stamps, receive_stamps;  ///< N; ns
  Clock clock;                                ///< which of them are the time
  Block q, qd;                                ///< n x N; rad, rad/s (prismatic m, m/s)
  Block effort;                               ///< n x N; as recorded; empty (0 x 0) if none was
  Block qdd;  ///< n x N; rad/s^2 (prismatic m/s^2); empty (0 x 0) if none was

  JointLogView(const StampsBlock& log_header_stamps, const StampsBlock& log_receive_stamps,
               Clock log_clock, const Block& log_q, const Block& log_qd, const Block& log_effort,
               const Block& log_qdd)
      : header_stamps(log_header_stamps),
        receive_stamps(log_receive_stamps),
        clock(log_clock),
        q(log_q),
        qd(log_qd),
        effort(log_effort),
        qdd(log_qdd) {}
  JointLogView(const JointLog& log)  // NOLINT(google-explicit-constructor)
      : JointLogView(log.header_stamps, log.receive_stamps, log.clock, log.q, log.qd, log.effort,
                     log.qdd) {}

  /// N; those stamps that are the time of the samples.
  const StampsBlock& stamps() const {
    return clock == Clock::kReceive ? receive_stamps : header_stamps;
  }

  /// N; s since the first sample.
  OwnedVector time() const { return secondsSince(stamps()[0], stamps()); }
};

/// Where accelerations come from.
enum class AccelerationMethod {
  kAuto,                ///< those recorded, if there are any; else kLowPass
  kLowPass,             ///< zero-phase low-pass of the velocities, then their derivative
  kBackwardDifference,  ///< backward differences; no filter
  kGiven,               ///< those recorded
};

/// `auto`, `low-pass`, `backward-difference` or `given`.
std::string name(AccelerationMethod method);

/// The method of that name. @throws EvaluationError: another text.
AccelerationMethod accelerationMethod(const std::string& name);

/// Accelerations, how they came about, and what was found in the samples.
struct LogAccelerations {
  OwnedMatrix qdd;  ///< n x N; rad/s^2 (prismatic m/s^2); of samples in memory, else empty
  AccelerationMethod method = AccelerationMethod::kLowPass;  ///< the one taken; not kAuto
  FilterChoice filter;                ///< what the low-pass did; all zero where there was none
  std::string summary;                ///< how they came about, in words
  SampleReport samples;               ///< what was found
  std::vector<std::string> findings;  ///< what is odd about the samples, a sentence each
};

/// How accelerations came about, in words, as titles and tables show it.
///
/// @param cutoff  Hz; of the low-pass. @param chosen  whether it was chosen from the data.
std::string accelerationSummary(AccelerationMethod method, double cutoff, bool chosen);

/// Accelerations of a log, as recorded or estimated from its velocities.
///
/// @param cutoff  Hz, of the low-pass; 0: chosen from the data. With kAuto it asks for a low-pass.
/// @param rules   which faults of the samples are acted upon.
/// @throws EvaluationError as lowPassAccelerations() and backwardDifference() do; a cut-off for a
///         method that has none; kGiven where none are recorded.
LogAccelerations logAccelerations(const JointLogView& log,
                                  AccelerationMethod method = AccelerationMethod::kAuto,
                                  double cutoff = 0, const SampleRules& rules = {});

/// What is odd about the samples of a recording, and what follows from it; one sentence each.
///
/// @param clock    whose stamps they have: `header` or `receive`.
/// @param samples  what was found.
/// @param filter   what the low-pass did; nullptr where there was none.
std::vector<std::string> sampleFindings(const std::string& clock, const SampleReport& samples,
                                        const FilterChoice* filter);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
