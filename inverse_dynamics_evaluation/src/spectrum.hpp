// SPDX-License-Identifier: Apache-2.0

/// @file
/// Spectra of the measured velocities, and of what the positions confirm of them.
///
///     VelocitySpectra spectra = velocitySpectra(stretches, 1000.0);

#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_evaluation/cutoff.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Samples without which a stretch says nothing about its spectrum.
constexpr Eigen::Index kLeastStretch = 16;

/// Summed periodograms of all joints; F frequencies from 0 to half the sampling frequency.
///
/// The common scale is arbitrary. [Welch 1967, doi 10.1109/TAU.1967.1161901]
struct VelocitySpectra {
  Eigen::ArrayXd frequency;  ///< F; Hz
  Eigen::ArrayXXd total;     ///< F x n; power of qd
  Eigen::ArrayXXd rate;      ///< F x n; power of the derivative of q
  Eigen::ArrayXXd common;  ///< F x n; real part of the cross-spectrum of qd and the derivative of q
  double moving = 0;       ///< share of the samples in motion
};

/// Hann window times activity(), linear trend removed, half overlap. A segment has a power of two
/// of samples, 10 to 20 s; a shorter stretch is one segment, padded with zeros.
///
/// Every sample of every stretch counts: each end is continued by its point reflection over half a
/// segment, since a window that falls to zero there would hide how the motion begins and ends.
/// Only sums over segments are kept, so the memory doesn't grow with the recording.
VelocitySpectra velocitySpectra(const std::vector<Stretch>& stretches, double sampling_frequency);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
