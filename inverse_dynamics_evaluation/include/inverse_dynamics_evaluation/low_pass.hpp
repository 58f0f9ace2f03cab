// SPDX-License-Identifier: Apache-2.0

/// @file
/// Zero-phase low-pass: a Butterworth filter forwards, then backwards, over equidistant samples.
///
///     Eigen::MatrixXd smooth = lowPass(qd, 125.0, 2.0);   // 125 Hz, cut-off 2 Hz
///
/// A Butterworth filter of order m passes a sine of frequency f with the power
///
///     |B(f)|^2 = 1 / (1 + (w / w_c)^(2 m)),   w = tan(pi f / f_s),   w_c = tan(pi f_c / f_s),
///
/// (f_s sampling frequency, f_c cut-off; the tangent is what the bilinear transformation does to
/// frequencies) and delays it. Run once more over the result backwards in time, it takes the delay
/// back and attenuates again: what remains is the real gain |B(f)|^2, one half at the cut-off, with
/// no delay at any frequency. That needs the future, so it is for recordings only.
///
/// At both ends the samples are continued by their point reflection, 2 x_0 - x_k, and the filter
/// starts in the steady state of the first value, so a constant passes unchanged. The result is
/// that of scipy.signal.sosfiltfilt with the same `padlen`.

#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Gain of the zero-phase low-pass, forwards and backwards, at a frequency: `|B(f)|^2`.
///
/// @param frequency,cutoff,sampling_frequency  Hz; 0 < cutoff < sampling_frequency / 2.
double lowPassGain(double frequency, double cutoff, double sampling_frequency, int order = 2);

/// Samples by which lowPass() continues each end if it isn't told: one and a half periods of the
/// cut-off, at least 3 (order + 1) samples, at most what there is.
Eigen::Index defaultPadding(Eigen::Index samples, double sampling_frequency, double cutoff,
                            int order = 2);

/// Each row of `samples`, zero-phase low-passed. O(n N).
///
/// @param samples             n x N, one sample per column, at equal distances in time.
/// @param sampling_frequency  Hz.
/// @param cutoff              Hz, below half the sampling frequency; gain one half there.
/// @param order               of the Butterworth filter that runs twice; 1 to 12.
/// @param padding             samples by which each end is continued, below N; negative: default.
/// @throws EvaluationError: cut-off, order or padding out of range; fewer than 3 (order + 1) + 1
///         samples; a number that isn't finite (joint and sample are named).
OwnedMatrix lowPass(const Eigen::Ref<const Eigen::MatrixXd>& samples, double sampling_frequency,
                    double cutoff, int order = 2, Eigen::Index padding = -1);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
