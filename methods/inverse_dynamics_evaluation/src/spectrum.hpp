// SPDX-License-Identifier: Apache-2.0

/// @file
/// Spectra of the measured velocities, and of what the positions confirm of them.
///
///     SpectrumSums sums(6, longest, 1000.0);
///     for (const Stretch& stretch : stretches) sums.add(stretch);
///     VelocitySpectra spectra = sums.spectra();

#pragma once

#include <Eigen/Core>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "inverse_dynamics_evaluation/cutoff.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A stretch of equidistant samples.
struct Stretch {
  Eigen::MatrixXd q;   ///< n x N; rad (prismatic m)
  Eigen::MatrixXd qd;  ///< n x N; rad/s (prismatic m/s)
};

/// Samples without which a stretch says nothing about its spectrum.
constexpr Eigen::Index kLeastStretch = 16;

/// Summed periodograms of all joints in B bands, each a twenty-fourth of an octave wide or one
/// frequency.
///
/// The common scale is arbitrary. [Welch 1967, doi 10.1109/TAU.1967.1161901]
struct VelocitySpectra {
  Eigen::ArrayXd frequency;  ///< B; Hz, root mean square of the frequencies in a band
  Eigen::ArrayXd count;      ///< B; frequencies in a band
  Eigen::ArrayXXd total;     ///< B x n; power of qd
  Eigen::ArrayXXd rate;      ///< B x n; power of the derivative of q
  Eigen::ArrayXXd common;  ///< B x n; real part of the cross-spectrum of qd and the derivative of q
  double moving = 0;       ///< share of the samples in motion
};

/// Sums over segments of samples, gathered stretch by stretch.
///
/// Hann window times the weight of motion (rests are left out), half overlap. A segment has a power of two of samples, 30 to 60 s;
/// a shorter stretch is one segment, padded with zeros.
class SpectrumSums {
 public:
  /// @param joints   n.
  /// @param longest  samples of the longest stretch that will be added.
  SpectrumSums(Eigen::Index joints, Eigen::Index longest, double sampling_frequency);

  /// A stretch of fewer than kLeastStretch samples is left out.
  void add(const Stretch& stretch);

  VelocitySpectra spectra() const;

 private:
  using Complex = std::complex<double>;

  void divideIntoBands(Eigen::Index half, double step);
  void add(const Eigen::ArrayXd& velocity, const Eigen::ArrayXd& rate, Eigen::Index j);

  double sampling_frequency_;
  Eigen::Index length_ = kLeastStretch;  // of a segment
  double samples_ = 0, moving_ = 0;
  VelocitySpectra spectra_;
  Eigen::FFT<double> fft_;
  std::vector<Eigen::Index> bands_;  // of each frequency
  std::vector<Complex> signal_, transform_;
};

/// @throws EvaluationError: fewer than kLeastStretch samples.
void requireLongEnough(Eigen::Index longest);

/// The cut-off that spectra tell: see cutoff.hpp. @param duration  s; of the longest piece.
CutoffChoice cutoffOf(const VelocitySpectra& spectra, double duration, double sampling_frequency,
                      int order);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
