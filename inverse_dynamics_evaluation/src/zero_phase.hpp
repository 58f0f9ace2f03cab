// SPDX-License-Identifier: Apache-2.0

/// @file
/// The zero-phase filter of low_pass.hpp over samples as they come, in bounded memory.
///
///     ZeroPhaseFilter filter(6, 0.02, 2, ZeroPhaseFilter::overlapOf(0.02, 2), take);
///     while (...) filter.push(samples);   // n x any number; take() gets the filtered ones
///     filter.finish();
///
/// Forwards, a recursive filter needs its state only. Backwards, it would have to start at the last
/// sample of the recording. But it forgets where it started: after `m` samples at least, what is
/// left of a wrong start is below rounding, so it runs over each block of samples from `m` samples
/// behind its end.
///
/// How long that takes. A section `y_k = ... - a1 y_(k-1) - a2 y_(k-2)` with poles `r exp(+-i phi)`
/// answers a wrong state by multiples of
///
///     g_k = r^k sin((k + 1) phi) / sin(phi),   |g_k| <= (k + 1) r^k
///
/// (the same bound holds for real poles up to r). A section after it convolves that error with an
/// impulse response of the same bound, and the convolution of (k + 1)^a r^k with (k + 1)^b r^k is
/// at most (k + 1)^(a + b + 1) r^k. So behind s sections, r being the slowest pole of all, the
/// error is at most a small constant per section times
///
///     (m + 1)^(2 s) r^m,
///
/// relative to the greatest sample. overlapOf() gives the m at which that is below 2^-60, with four
/// bits per section for the constants: a hundredth of a rounding error.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What a filter of this order needs, of which each end is continued.
constexpr Eigen::Index leastSamples(int order) { return 3 * (order + 1) + 1; }

/// Takes the next columns of a result; the reference holds during the call.
using TakeColumns = std::function<void(const Eigen::Ref<const Eigen::MatrixXd>&)>;

/// @throws EvaluationError: sampling frequency, cut-off or order out of range.
void requireFilter(double sampling_frequency, double cutoff, int order);

/// Butterworth filter forwards, then backwards; starts in the steady state of the first value at
/// either end. No continuation of the ends: see low_pass.hpp and low_pass_derivative.hpp.
class ZeroPhaseFilter {
 public:
  /// Blocks are as long as the recording: the filter backwards starts at the last sample only.
  static constexpr Eigen::Index kWhole = -1;

  /// @param joints                n.
  /// @param cutoff_over_sampling  0 to 0.5; gain one half there.
  /// @param order                 1 to 12.
  /// @param overlap               samples by which blocks overlap, or kWhole.
  /// @param take                  gets as many columns as were pushed, in their order.
  ZeroPhaseFilter(Eigen::Index joints, double cutoff_over_sampling, int order, Eigen::Index overlap,
                  TakeColumns take);

  /// Samples after which a wrong start makes no difference.
  static Eigen::Index overlapOf(double cutoff_over_sampling, int order);

  /// The next samples, n x any number.
  void push(const Eigen::Ref<const Eigen::MatrixXd>& samples);

  /// There is no further sample: gives the rest.
  void finish();

 private:
  // y_k = b0 x_k + b1 x_(k-1) + b2 x_(k-2) - a1 y_(k-1) - a2 y_(k-2), with a gain of one at 0 Hz
  struct Section {
    double b0, b1, b2, a1, a2;
  };
  // Of transposed direct form II; one number per joint.
  struct State {
    Eigen::ArrayXd first, second;
  };

  static std::vector<Section> butterworth(int order, double cutoff_over_sampling);
  static State steady(const Section& section, const Eigen::Ref<const Eigen::VectorXd>& value);
  static void filterColumn(const Section& section, State& state, double* column);
  void reserve(Eigen::Index more);
  void backwards(Eigen::Index give);

  std::vector<Section> sections_;
  Eigen::Index overlap_;
  TakeColumns take_;
  std::vector<State> forwards_;  // empty before the first sample
  Eigen::MatrixXd waiting_;      // filtered forwards, with room for more than count_
  Eigen::Index count_ = 0;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
