// SPDX-License-Identifier: Apache-2.0

/// @file
/// The rules of samples.hpp over a table: faults, time base, pieces between gaps; turns of joints.
///
///     const std::vector<std::string> jumps = unwrapPositions(table, types, joint_names);
///     const Examination found = examine(table, rules);
///     table.instant[k], table.kept[k];

#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/sample_table.hpp"
#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Samples between two gaps.
struct Piece {
  Eigen::Index first = 0;   ///< number of its first sample
  Eigen::Index behind = 0;  ///< of the first one that isn't in it
  Eigen::Index used = 0;    ///< how many have an instant of their own
  double begin = 0;         ///< s; of the first of those
  double end = 0;           ///< s; of the last of those
};

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

/// Makes positions of continuous joints go on where they jump by a turn from one sample to the next.
///
/// Such jumps of revolute joints stay as they are. Nothing changes if there are other joints than
/// types: that is refused elsewhere.
///
/// @param joint_names  for the texts.
/// @return a sentence for each revolute joint that jumps.
std::vector<std::string> unwrapPositions(SampleTable& table,
                                         const std::vector<chain_dynamics::JointType>& types,
                                         const std::vector<std::string>& joint_names);

/// Samples with those instants [s], as a table.
std::unique_ptr<SampleTable> tableOf(const Eigen::Ref<const Eigen::VectorXd>& time,
                                     const Eigen::Ref<const Eigen::MatrixXd>& q,
                                     const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                     const Eigen::Ref<const Eigen::MatrixXd>& effort);

/// Copies the table's flags and instants into a report.
void addSeries(const SampleTable& table, SampleReport& report);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
