// SPDX-License-Identifier: Apache-2.0

/// @file
/// Equidistant samples from samples that aren't, weighted sums of four neighbours each.
///
///     Resampler resampler(table, grid);
///     for (Index i = 0; i < grid.count; ++i) {
///       resampler.next();
///       values.col(i) = resampler.valueOf(table.qd);
///     }
///
/// A value lies on the cubic through the four samples around its instant, or on a straight line
/// where two of these are so close, or so far apart, that a cubic would enlarge their noise.

#pragma once

#include <Eigen/Core>
#include <array>

#include "inverse_dynamics_evaluation/sample_table.hpp"
#include "time_base.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A piece, and the equidistant samples that stand for it.
struct Grid : Piece {
  Eigen::Index count = 0;  ///< of the equidistant samples
  double period = 0;       ///< s; between them

  /// @param usual_period  s; about their distance. There are at least as many as used samples.
  Grid(const Piece& piece, double usual_period);
};

/// Goes through the equidistant samples of a piece.
class Resampler {
 public:
  /// @param grid  of a piece with at least four used samples.
  Resampler(const SampleTable& table, const Grid& grid);

  /// Weighs the neighbours of the next equidistant sample.
  void next();

  /// The value there of columns of the table.
  template <class Columns>
  auto valueOf(const Columns& columns) const {
    return weights_[0] * columns.col(samples_[0]) + weights_[1] * columns.col(samples_[1]) +
           weights_[2] * columns.col(samples_[2]) + weights_[3] * columns.col(samples_[3]);
  }

 private:
  bool advance();

  const SampleTable& table_;
  const Grid& grid_;
  Eigen::Index made_ = 0;
  Eigen::Index ahead_;                   // first sample behind the four
  std::array<Eigen::Index, 4> samples_;  // neighbours in the table, all used
  Eigen::Vector4d instants_;             // s; of them
  Eigen::Vector4d weights_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
