// SPDX-License-Identifier: Apache-2.0

#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSegmentSeconds = 20.0;
constexpr Eigen::Index kMostSegments = 40;  // of a stretch: spread evenly over a long one
// a central difference hardly sees frequencies near half the sampling frequency: no more than this
// is divided out
constexpr double kLeastDifferenceGain = 0.05;

using Complex = std::complex<double>;

// Hann window, periodic.
Eigen::ArrayXd hann(Eigen::Index length) {
  const Eigen::ArrayXd angle =
      Eigen::ArrayXd::LinSpaced(length, 0.0, static_cast<double>(length - 1)) * 2.0 * kPi /
      static_cast<double>(length);
  return 0.5 - 0.5 * angle.cos();
}

// The straight line of least squares taken away.
void removeTrend(Eigen::ArrayXd& x) {
  const auto count = static_cast<double>(x.size());
  const Eigen::ArrayXd k =
      Eigen::ArrayXd::LinSpaced(x.size(), -(count - 1.0) / 2.0, (count - 1.0) / 2.0);
  const double slope = (k * x).sum() / k.square().sum();
  x -= x.mean() + slope * k;
}

// Sample k of the derivative of q: central differences, one-sided at the ends; per sample, not per
// s.
double positionStep(const Stretch& stretch, Eigen::Index j, Eigen::Index k) {
  const Eigen::Index before = std::max<Eigen::Index>(k - 1, 0);
  const Eigen::Index after = std::min(k + 1, stretch.q.cols() - 1);
  return (stretch.q(j, after) - stretch.q(j, before)) / static_cast<double>(after - before);
}

// Adds the periodograms of one segment of one joint. Both signals are real, so one transform of
// `qd + i dq` holds both: qd is its conjugate-symmetric part, i dq the rest.
void addSegment(const Stretch& stretch, Eigen::Index j, Eigen::Index begin,
                double sampling_frequency, const Eigen::ArrayXd& window, Eigen::FFT<double>& fft,
                std::vector<Complex>& signal, std::vector<Complex>& transform,
                VelocitySpectra& spectra) {
  const Eigen::Index length = window.size();
  Eigen::ArrayXd velocity = stretch.qd.row(j).segment(begin, length).transpose().array();
  Eigen::ArrayXd position_rate(length);
  for (Eigen::Index k = 0; k < length; ++k) {
    position_rate[k] = positionStep(stretch, j, begin + k) * sampling_frequency;
  }
  removeTrend(velocity);
  removeTrend(position_rate);
  for (Eigen::Index k = 0; k < length; ++k) {
    signal[static_cast<std::size_t>(k)] = window[k] * Complex(velocity[k], position_rate[k]);
  }
  fft.fwd(transform, signal);

  const std::size_t size = transform.size();
  for (Eigen::Index i = 0; i < spectra.frequency.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Complex here = transform[k];
    const Complex mirrored = std::conj(transform[(size - k) % size]);
    const Complex velocity_part = 0.5 * (here + mirrored);
    const Complex position_part = Complex(0.0, -0.5) * (here - mirrored);
    spectra.total(i, j) += std::norm(velocity_part);
    spectra.common(i, j) += (velocity_part * std::conj(position_part)).real();
  }
}

// Samples of a segment: as many as the longest stretch allows, up to 20 s.
Eigen::Index segmentLength(const std::vector<Stretch>& stretches, double sampling_frequency) {
  Eigen::Index longest = 0;
  for (const Stretch& stretch : stretches) {
    longest = std::max(longest, stretch.qd.cols());
  }
  return std::min(longest,
                  static_cast<Eigen::Index>(std::ceil(kSegmentSeconds * sampling_frequency)));
}

// Where the segments of a stretch begin; the last one ends where the stretch ends.
std::vector<Eigen::Index> segmentBegins(Eigen::Index samples, Eigen::Index length) {
  const Eigen::Index spare = samples - length;
  if (spare < 0) {
    return {};
  }
  const Eigen::Index half = std::max<Eigen::Index>(length / 2, 1);
  const Eigen::Index steps = std::min((spare + half - 1) / half, kMostSegments - 1);
  std::vector<Eigen::Index> begins = {0};
  for (Eigen::Index s = 1; s <= steps; ++s) {
    begins.push_back(s * spare / steps);
  }
  return begins;
}

}  // namespace

VelocitySpectra velocitySpectra(const std::vector<Stretch>& stretches, double sampling_frequency) {
  const Eigen::Index length = segmentLength(stretches, sampling_frequency);
  Eigen::Index padded = 1;
  while (padded < length) {
    padded *= 2;
  }

  const Eigen::Index joints = stretches.front().qd.rows();
  const Eigen::Index frequencies = padded / 2 + 1;
  VelocitySpectra spectra;
  spectra.frequency = Eigen::ArrayXd::LinSpaced(frequencies, 0.0, sampling_frequency / 2.0);
  spectra.total = Eigen::ArrayXXd::Zero(frequencies, joints);
  spectra.common = Eigen::ArrayXXd::Zero(frequencies, joints);

  const Eigen::ArrayXd window = hann(length);
  Eigen::FFT<double> fft;
  std::vector<Complex> signal(static_cast<std::size_t>(padded), Complex(0.0, 0.0));
  std::vector<Complex> transform;
  for (const Stretch& stretch : stretches) {
    for (const Eigen::Index begin : segmentBegins(stretch.qd.cols(), length)) {
      for (Eigen::Index j = 0; j < joints; ++j) {
        addSegment(stretch, j, begin, sampling_frequency, window, fft, signal, transform, spectra);
      }
    }
  }

  // a central difference passes frequency w with the gain sin(w) / w
  for (Eigen::Index i = 1; i < frequencies; ++i) {
    const double w = kPi * static_cast<double>(i) / static_cast<double>(frequencies - 1);
    spectra.common.row(i) /= std::max(std::sin(w) / w, kLeastDifferenceGain);
  }
  return spectra;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
