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

/// Averaged periodograms of all joints; F frequencies from 0 to half the sampling frequency.
///
/// The common scale is arbitrary. [Welch 1967, doi 10.1109/TAU.1967.1161901]
struct VelocitySpectra {
  Eigen::ArrayXd frequency;  ///< F; Hz
  Eigen::ArrayXXd total;     ///< F x n; power of qd
  Eigen::ArrayXXd common;  ///< F x n; real part of the cross-spectrum of qd and the derivative of q
};

/// Linear trend removed, Hann window, half overlap, 20 s a segment or the longest stretch, padded
/// with zeros to a power of two; 40 segments of a stretch at most, evenly spread. Stretches shorter
/// than a segment are left out.
VelocitySpectra velocitySpectra(const std::vector<Stretch>& stretches, double sampling_frequency);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
