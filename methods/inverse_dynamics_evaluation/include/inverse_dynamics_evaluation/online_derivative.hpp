// SPDX-License-Identifier: Apache-2.0

/// @file
/// Causal derivative of samples at any distances in time.
///
///     OnlineDerivative accelerations(6, 5.0);                  // 6 joints, cut-off 5 Hz
///     accelerations.update(stamp, qd);
///     if (accelerations.settled()) use(accelerations.derivative());
///
/// The samples u go through a critically damped low-pass of second order, whose state holds the
/// derivative:
///
///     y'' = w^2 (u - y) - 2 w y',   w = 2 pi f_c,   derivative = y'
///
/// Its gain at a frequency f is that of a derivative, 2 pi f, times 1 / (1 + (f / f_c)^2): one half
/// at the cut-off f_c, as of lowPass(). Unlike the filter of recordings, this one delays its input
/// by 2 / w = 1 / (pi f_c), at 5 Hz by 64 ms. A higher cut-off means less delay and more noise.
///
/// Between two samples u is taken as a straight line, and the equation is solved exactly: right for
/// any distance of samples, stable for any cut-off, without overshoot.

#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Filtered derivative of n numbers.
///
/// Real time: update() allocates nothing, takes no lock, throws nothing for n numbers.
class OnlineDerivative {
 public:
  /// Effect of a sample.
  enum class Step {
    kStarted,    ///< the first sample
    kContinued,  ///< filtered
    kRepeated,   ///< same stamp as the sample before: ignored
    kWentBack,   ///< earlier stamp: the filter restarts
    kGap,        ///< after a gap: the filter restarts
  };

  /// @param size         n.
  /// @param cutoff       f_c [Hz], above 0.
  /// @param longest_gap  longest distance of two samples [s] without a restart, above 0.
  /// @throws EvaluationError: out of range.
  OnlineDerivative(Eigen::Index size, double cutoff, double longest_gap = 0.5);

  /// Filters a sample. @param stamp  ns. @param u  n, finite; positions of continuous joints must be
  /// unwrapped: chain_dynamics::unwrap().
  Step update(std::int64_t stamp, const Eigen::Ref<const Eigen::VectorXd>& u);

  /// The next sample is the first one.
  void reset() { started_ = false; }

  /// Whether the transient has decayed to 1 %: 1.05 / f_c after the start.
  bool settled() const;

  /// n; in units of u per second.
  const OwnedVector& derivative() const { return derivative_; }

  /// n; the low-passed samples themselves, as late as the derivative.
  const OwnedVector& value() const { return value_; }

  /// Delay of slow changes [s]: `1 / (pi f_c)`.
  double delay() const { return 2.0 / w_; }

 private:
  void start(std::int64_t stamp, const Eigen::Ref<const Eigen::VectorXd>& u);

  double w_;            // rad/s
  double longest_gap_;  // s
  bool started_ = false;
  std::int64_t begin_ = 0, last_ = 0;  // ns; of the first and the latest sample
  OwnedVector input_;                  // u of the latest sample
  OwnedVector value_;                  // y
  OwnedVector derivative_;             // y'
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
