// SPDX-License-Identifier: Apache-2.0

/// @file
/// lowPassDerivative() of samples as they come, in bounded memory.
///
///     LowPassDifferentiator differentiator(6, count, 125.0, 2.0, 2, take);
///     while (...) differentiator.push(samples);   // count of them in all
///     differentiator.finish();
///
/// What is kept: some periods of the cut-off, of the samples at either end (their continuation is
/// fitted to them) and of those that the filter needs from behind a block [zero_phase.hpp].

#pragma once

#include <Eigen/Core>

#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Both ends continued by cubics [ends.hpp], zero-phase low-pass, central differences.
class LowPassDifferentiator {
 public:
  /// @param joints  n.
  /// @param count   N; how many samples will come.
  /// @param take    gets n x N derivatives, some columns at a time.
  LowPassDifferentiator(Eigen::Index joints, Eigen::Index count, double sampling_frequency,
                        double cutoff, int order, TakeColumns take);
  LowPassDifferentiator(const LowPassDifferentiator&) = delete;
  LowPassDifferentiator& operator=(const LowPassDifferentiator&) = delete;

  /// The next samples, n x any number.
  void push(const Eigen::Ref<const Eigen::MatrixXd>& samples);

  /// All samples have come: gives the rest.
  void finish();

 private:
  void begin();
  void filterWhole();
  void differentiate(const Eigen::Ref<const Eigen::MatrixXd>& filtered);

  Eigen::Index count_;
  double sampling_frequency_;
  Eigen::Index fit_;     // samples that an end's cubic is fitted to
  Eigen::Index beyond_;  // samples by which it continues the end
  Eigen::Index mirror_;  // samples by which a point reflection continues that
  Eigen::Index end_;     // samples kept of either end
  TakeColumns take_;
  ZeroPhaseFilter filter_;
  Eigen::MatrixXd first_;       // end_ samples
  Eigen::MatrixXd last_;        // up to end_ samples
  Eigen::Index pushed_ = 0;     // samples
  Eigen::Index skip_;           // filtered columns that aren't needed any more
  Eigen::MatrixXd neighbours_;  // filtered columns whose derivative isn't known yet
  Eigen::Index given_ = 0;      // derivatives
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
