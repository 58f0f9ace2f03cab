// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples of a piece between gaps at equal distances in time, as the filter and the spectra need
/// them.
///
///     Resampler resampler(grid, 6, take);
///     while (...) resampler.add(instant, qd.col(k).data());
///
/// A value lies on the cubic through the four samples around its instant, or on a straight line
/// where two of these are so close, or so far apart, that a cubic would enlarge their noise.

#pragma once

#include <Eigen/Core>

#include "time_base.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A piece, and the equidistant samples that stand for it.
struct Grid : Piece {
  Eigen::Index count = 0;  ///< of the equidistant samples
  double period = 0;       ///< s; between them

  /// @param usual_period  s; about their distance. There are at least as many as used samples.
  Grid(const Piece& piece, double usual_period);
};

/// Makes equidistant samples of those of a piece.
class Resampler {
 public:
  /// @param rows  numbers of a sample.
  /// @param take  gets rows x grid.count numbers, some columns at a time.
  Resampler(const Grid& grid, Eigen::Index rows, TakeColumns take);

  /// The next one of grid.used samples, at least four. @param numbers  `rows` of them.
  void add(double instant, const double* numbers);

  /// How many were added.
  Eigen::Index added() const { return added_; }

 private:
  void giveValue(double t);
  void flush();

  Grid grid_;
  TakeColumns take_;
  Eigen::Vector4d instants_ = Eigen::Vector4d::Zero();  // of the last four samples
  Eigen::Matrix<double, Eigen::Dynamic, 4> numbers_;    // likewise
  Eigen::Index added_ = 0;
  Eigen::Index made_ = 0;     // equidistant samples
  Eigen::Index right_ = 1;    // number of the second of the two samples around an instant
  Eigen::MatrixXd values_;    // equidistant samples that weren't given yet
  Eigen::Index waiting_ = 0;  // of them
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
