// SPDX-License-Identifier: Apache-2.0

/// @file
/// The rules of samples.hpp over a table: faults, time base, pieces between gaps.
///
///     const Examination found = examine(table, rules);
///     table.instant[k], table.kept[k];

#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "inverse_dynamics_evaluation/sample_table.hpp"
#include "inverse_dynamics_evaluation/samples.hpp"
#include "time_base.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What is found in a table.
struct Examination {
  SampleReport report;        ///< without what has a number for each sample: the table has it
  std::vector<Piece> pieces;  ///< of `shortest_piece` used samples or more
  double usual_period = 0;    ///< s; median distance of the used samples
};

/// Fills the table's flags and instants.
///
/// A repeat has the instant of the sample it repeats; one left out for its stamp lies between its
/// neighbours in the recording. @throws EvaluationError: see examineSamples().
Examination examine(SampleTable& table, const SampleRules& rules);

/// Samples with those instants [s], as a table.
std::unique_ptr<SampleTable> tableOf(const Eigen::Ref<const Eigen::VectorXd>& time,
                                     const Eigen::Ref<const Eigen::MatrixXd>& q,
                                     const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                     const Eigen::Ref<const Eigen::MatrixXd>& effort);

/// A log as a table.
std::unique_ptr<SampleTable> tableOf(const JointLogView& log);

/// Copies the table's flags and instants into a report.
void addSeries(const SampleTable& table, SampleReport& report);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
