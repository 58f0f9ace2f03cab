// SPDX-License-Identifier: Apache-2.0
/// @file
/// The filter that makes the noise of a joint white: the innovations of a Kalman filter whose one
/// state is the correlated noise. It is linear, so rows of a regression may go through it.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Kalman gains of the noise of one joint: the same for all columns of a regression.
class NoiseFilter {
 public:
  /// Variances of the white and the correlated noise; s.
  NoiseFilter(double white, double correlated, double time)
      : white_(white), correlated_(correlated), time_(time), predicted_(correlated) {}

  void restart() {
    predicted_ = correlated_;
    started_ = false;
  }

  /// The next sample, `period` s after the last one; of the first one it has no meaning.
  void advance(double period) {
    memory_ = started_ ? std::exp(-period / time_) : 0.0;
    if (started_) {
      const double kept = (1.0 - gain_) * predicted_;
      predicted_ = memory_ * memory_ * kept + correlated_ * (1.0 - memory_ * memory_);
    }
    variance_ = predicted_ + white_;
    gain_ = predicted_ / variance_;
    started_ = true;
  }

  double variance() const { return variance_; }

  /// Innovations of the columns, of unit variance for noise alone. state: of each column, finite;
  /// the first sample takes nothing from it. It is updated.
  template <typename Columns>
  Columns innovations(const Columns& columns, Columns& state) const {
    const Columns predicted = memory_ * state;
    const Columns innovation = columns - predicted;
    state = predicted + gain_ * innovation;
    return innovation / std::sqrt(variance_);
  }

  /// The same for any number of columns, in place.
  void whiten(Eigen::VectorXd& columns, Eigen::VectorXd& state) const {
    const double scale = 1.0 / std::sqrt(variance_);
    for (Eigen::Index c = 0; c < columns.size(); ++c) {
      const double predicted = memory_ * state[c], innovation = columns[c] - predicted;
      state[c] = predicted + gain_ * innovation;
      columns[c] = scale * innovation;
    }
  }

 private:
  double white_, correlated_, time_;
  double predicted_, memory_ = 0.0, gain_ = 0.0, variance_ = 1.0;
  bool started_ = false;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
