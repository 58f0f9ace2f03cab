// SPDX-License-Identifier: Apache-2.0

/// @file
/// Accelerations of a table of samples.
///
///     const LogAccelerations found = findAccelerations(table, options);
///     table.qdd.col(k);

#pragma once

#include "inverse_dynamics_evaluation/log_accelerations.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What is asked for, see logAccelerations().
struct AccelerationOptions {
  AccelerationMethod method = AccelerationMethod::kAuto;
  double cutoff = 0;  ///< Hz; 0: chosen from the data
  int order = LowPassOptions().order;
  SampleRules rules;
};

/// Refuses stamps, positions, velocities, efforts or accelerations of different lengths, and fewer
/// than two samples. @throws EvaluationError
void checkLog(const JointLogView& log);

/// Refuses a cut-off [Hz] that no filter has, or for a method that has none; 0: chosen from the data.
/// @throws EvaluationError
void checkCutoff(AccelerationMethod method, double cutoff);

/// Fills accelerations, instants and flags of a table.
///
/// @return without what has a number for each sample. @throws EvaluationError: see
///         logAccelerations().
LogAccelerations findAccelerations(SampleTable& table, const AccelerationOptions& options);

/// Backward differences: backwardDifference().
void backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                        const Eigen::Ref<const Eigen::MatrixXd>& qd,
                        Eigen::Ref<Eigen::MatrixXd> qdd);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
