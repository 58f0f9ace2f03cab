// SPDX-License-Identifier: Apache-2.0

#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "activity.hpp"
#include "pi.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// a motion of a tenth of a hertz and the noise above it need lines this narrow
constexpr double kSegmentSeconds = 60.0;
constexpr double kBandsPerOctave = 24.0;  // narrow against the slope of the low-pass
// a central difference hardly sees frequencies near half the sampling frequency: no more than this
// is divided out
constexpr double kLeastDifferenceGain = 0.05;
// of the root mean square by which rates leave the range of the velocities around them: what noise
// doesn't reach
constexpr double kJump = 10.0;

using Complex = std::complex<double>;

// Hann window, periodic.
Eigen::ArrayXd hann(Index length) {
  const Eigen::ArrayXd angle =
      Eigen::ArrayXd::LinSpaced(length, 0.0, static_cast<double>(length - 1)) * 2.0 * kPi /
      static_cast<double>(length);
  return 0.5 - 0.5 * angle.cos();
}

// Derivative of q: central differences, one-sided at the ends.
//
// Where q jumps and qd doesn't (a seam of 2 pi, a driver that starts anew), the rate before lasts:
// between two samples it can't leave the range of the velocities around them by more than its width
// and noise.
Eigen::ArrayXd positionRate(const Eigen::ArrayXd& q, const Eigen::ArrayXd& qd,
                            double sampling_frequency) {
  const Index last = q.size() - 1;
  Eigen::ArrayXd rate = sampling_frequency * (q.tail(last) - q.head(last));
  Eigen::ArrayXd width(last), beyond(last);
  for (Index k = 0; k < last; ++k) {
    const Index first = std::max<Index>(k - 1, 0);
    const auto around = qd.segment(first, std::min(k + 2, last) - first + 1);
    const double least = around.minCoeff(), greatest = around.maxCoeff();
    width[k] = greatest - least;
    beyond[k] = std::max({least - rate[k], rate[k] - greatest, 0.0});
  }
  const double limit = kJump * std::sqrt(beyond.square().mean());
  for (Index k = 2; k + 1 < last; ++k) {
    if (beyond[k] > std::max(limit, width[k])) {  // samples between two stamps share a jump
      rate.segment(k - 1, 3).setConstant(rate[k - 2]);
    }
  }
  Eigen::ArrayXd central(q.size());
  central << rate[0], 0.5 * (rate.tail(last - 1) + rate.head(last - 1)), rate[last - 1];
  return central;
}

// Where the segments of a signal begin; the last one ends where the signal ends.
std::vector<Index> segmentBegins(Index samples, Index length) {
  const Index spare = samples - length;
  const Index half = std::max<Index>(length / 2, 1);
  const Index steps = (spare + half - 1) / half;
  std::vector<Index> begins = {0};
  for (Index s = 1; s <= steps; ++s) {
    begins.push_back(s * spare / steps);
  }
  return begins;
}

}  // namespace

// Adds the periodograms of segments, one at a time.
class SpectrumSums::Sums {
 public:
  Sums(VelocitySpectra& spectra, Index padded, double sampling_frequency, Index joints)
      : spectra_(spectra), signal_(static_cast<std::size_t>(padded), Complex(0.0, 0.0)) {
    divideIntoBands(padded / 2, sampling_frequency / static_cast<double>(padded));
    spectra_.total = Eigen::ArrayXXd::Zero(spectra_.count.size(), joints);
    spectra_.rate = spectra_.common = spectra_.total;
  }

  // Both signals are real, so one transform of `qd + i dq` holds both: qd is its
  // conjugate-symmetric part, i dq the rest.
  void add(const Eigen::ArrayXd& velocity, const Eigen::ArrayXd& rate, Index j) {
    std::fill(signal_.begin(), signal_.end(), Complex(0.0, 0.0));
    for (Index k = 0; k < velocity.size(); ++k) {
      signal_[static_cast<std::size_t>(k)] = Complex(velocity[k], rate[k]);
    }
    fft_.fwd(transform_, signal_);

    const std::size_t size = transform_.size();
    for (std::size_t k = 1; k < size / 2; ++k) {
      const Complex here = transform_[k];
      const Complex mirrored = std::conj(transform_[size - k]);
      // a central difference passes frequency w with the gain sin(w) / w
      const double w = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(size);
      const double gain = std::max(std::sin(w) / w, kLeastDifferenceGain);
      const Complex velocity_part = 0.5 * (here + mirrored);
      const Complex position_part = Complex(0.0, -0.5 / gain) * (here - mirrored);
      const Index band = bands_[k];
      spectra_.total(band, j) += std::norm(velocity_part);
      spectra_.rate(band, j) += std::norm(position_part);
      spectra_.common(band, j) += (velocity_part * std::conj(position_part)).real();
    }
  }

 private:
  // Frequencies 1 to `half` - 1 of a transform, `step` Hz apart.
  void divideIntoBands(Index half, double step) {
    std::vector<double> counts, squares;
    bands_.assign(static_cast<std::size_t>(half), 0);
    double end = 1.0;
    for (Index k = 1; k < half; ++k) {
      if (static_cast<double>(k) >= end) {
        end = std::max(static_cast<double>(k) * std::exp2(1.0 / kBandsPerOctave),
                       static_cast<double>(k + 1));
        counts.push_back(0.0);
        squares.push_back(0.0);
      }
      counts.back() += 1.0;
      squares.back() += std::pow(step * static_cast<double>(k), 2);
      bands_[static_cast<std::size_t>(k)] = static_cast<Index>(counts.size()) - 1;
    }
    const auto size = static_cast<Index>(counts.size());
    spectra_.count = Eigen::Map<const Eigen::ArrayXd>(counts.data(), size);
    spectra_.frequency =
        (Eigen::Map<const Eigen::ArrayXd>(squares.data(), size) / spectra_.count).sqrt();
  }

  VelocitySpectra& spectra_;
  Eigen::FFT<double> fft_;
  std::vector<Index> bands_;  // of each frequency
  std::vector<Complex> signal_;
  std::vector<Complex> transform_;
};

SpectrumSums::SpectrumSums(Index joints, Index longest, double sampling_frequency)
    : sampling_frequency_(sampling_frequency), length_(kLeastStretch) {
  while (static_cast<double>(2 * length_) <= kSegmentSeconds * sampling_frequency &&
         length_ < longest) {
    length_ *= 2;
  }
  sums_ = std::make_unique<Sums>(spectra_, length_, sampling_frequency, joints);
}

SpectrumSums::~SpectrumSums() = default;

void SpectrumSums::add(const Stretch& stretch) {
  const Index samples = stretch.qd.cols();
  if (samples < kLeastStretch) {
    return;
  }
  const Eigen::ArrayXd weight = activity(stretch, sampling_frequency_);
  moving_ += weight.sum();
  samples_ += static_cast<double>(samples);
  const Index length = std::min(length_, samples);
  const Eigen::ArrayXd shape = hann(length);
  const std::vector<Index> begins = segmentBegins(samples, length);
  for (Index j = 0; j < stretch.qd.rows(); ++j) {
    const Eigen::ArrayXd velocity = stretch.qd.row(j).transpose();
    const Eigen::ArrayXd rate =
        positionRate(stretch.q.row(j).transpose(), velocity, sampling_frequency_);
    for (const Index begin : begins) {
      const Eigen::ArrayXd window = shape * weight.segment(begin, length);
      sums_->add(window * velocity.segment(begin, length), window * rate.segment(begin, length), j);
    }
  }
}

VelocitySpectra SpectrumSums::spectra() const {
  VelocitySpectra spectra = spectra_;
  spectra.moving = samples_ > 0 ? moving_ / samples_ : 0.0;
  return spectra;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
