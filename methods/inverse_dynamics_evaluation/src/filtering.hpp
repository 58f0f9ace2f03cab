// SPDX-License-Identifier: Apache-2.0

/// @file
/// The filter of accelerations.hpp in place, and words for what it did.

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/accelerations.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Room for samples and their continuation beyond both ends: cubics, then point reflections.
///
///     const DerivativeRoom room(count, 125.0, 2.0, 2);
///     Eigen::MatrixXd columns(6, room.size());
///     columns.middleCols(room.begin(), count) = qd;
///     const auto qdd = room.differentiate(columns);   // where they lie: nothing is copied
struct DerivativeRoom {
  /// @param samples  how many there are.
  DerivativeRoom(Eigen::Index samples, double frequency, double cutoff_frequency, int filter_order);

  /// Columns that the room has.
  Eigen::Index size() const { return count + 2 * begin(); }
  /// Number of the first sample's column.
  Eigen::Index begin() const { return mirror + beyond; }

  /// Derivatives [1/s] of the samples, zero-phase low-passed.
  ///
  /// @param room  n x size(), samples in their columns; lost afterwards.
  /// @return n x count columns of the room.
  Eigen::Ref<Eigen::MatrixXd> differentiate(Eigen::Ref<Eigen::MatrixXd> room) const;

  Eigen::Index count;
  double sampling_frequency, cutoff;  // Hz
  int order;
  Eigen::Index fit = 0;     // samples that an end's cubic is fitted to
  Eigen::Index beyond = 0;  // samples by which it continues the end
  Eigen::Index mirror = 0;  // samples by which a point reflection continues that
};

/// Refuses a cut-off [Hz] that no filter has, or for a method that has none; 0: chosen from the data.
/// @throws EvaluationError
void checkCutoff(AccelerationMethod method, double cutoff);

/// Findings about the samples of a recording and their consequences, one sentence each.
///
/// @param clock    whose stamps they have: `header` or `receive`.
/// @param samples  what was found.
/// @param filter   what the low-pass did; nullptr where there was none.
std::vector<std::string> sampleFindings(const std::string& clock, const SampleReport& samples,
                                        const FilterChoice* filter);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
