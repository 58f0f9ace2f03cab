// SPDX-License-Identifier: Apache-2.0
/// @file
/// The filter that makes the noise of a joint white: the innovations of a Kalman filter whose one
/// state is the correlated noise. It is linear, so rows of a regression may go through it.
///
/// Where correlated noise prevails, the filter differentiates, and amplifies the noise of
/// accelerations, which is in the regressor too: an estimate shrinks as that noise grows. So it gets
/// means over a tenth of the correlation time: faster noise is averaged, and counts as white.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace inverse_dynamics_identification {
inline namespace v2 {

/// A run of neighbouring samples that go through the filter as their mean.
class MeanSpan {
 public:
  explicit MeanSpan(double correlation_time) : length_(kShare * correlation_time) {}

  void restart() { count_ = 0; }
  bool isEmpty() const { return count_ == 0; }
  /// Whether a sample at this time is no longer part of it.
  bool endsBefore(double time) const { return count_ > 0 && !(time - begin_ < length_); }
  void add(double time) {
    if (count_ == 0) {
      begin_ = time;
      sum_ = 0.0;
    }
    sum_ += time - begin_;
    ++count_;
  }
  /// Of its samples, the mean; s.
  double time() const { return begin_ + sum_ / count_; }
  /// Of each sample in the mean.
  double weight() const { return 1.0 / count_; }

 private:
  static constexpr double kShare = 0.099;  // samples of 50 Hz stay apart, rounding or not

  double length_, begin_ = 0.0, sum_ = 0.0;
  int count_ = 0;
};

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
