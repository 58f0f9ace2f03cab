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

constexpr double kSegmentSeconds = 20.0;
constexpr double kEndSeconds = 0.05;  // over which the value at an end is averaged
// a central difference hardly sees frequencies near half the sampling frequency: no more than this
// is divided out
constexpr double kLeastDifferenceGain = 0.05;

using Complex = std::complex<double>;

// Hann window, periodic.
Eigen::ArrayXd hann(Index length) {
  const Eigen::ArrayXd angle =
      Eigen::ArrayXd::LinSpaced(length, 0.0, static_cast<double>(length - 1)) * 2.0 * kPi /
      static_cast<double>(length);
  return 0.5 - 0.5 * angle.cos();
}

// x times the window, less the straight line of least squares under it.
void applyWindow(const Eigen::ArrayXd& window, Eigen::ArrayXd& x) {
  const auto count = static_cast<double>(x.size());
  const double sum = window.sum();
  if (!(sum > 0)) {
    x.setZero();
    return;
  }
  Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(x.size(), 0.0, count - 1.0);
  k -= (window * k).sum() / sum;
  const double mean = (window * x).sum() / sum;
  const double squares = (window * k.square()).sum();
  const double slope = squares > 0 ? (window * k * x).sum() / squares : 0.0;
  x = window * (x - mean - slope * k);
}

// Value at the first of some samples: that of the straight line of least squares through them.
double valueAtFirst(const Eigen::ArrayXd& x) {
  const auto count = static_cast<double>(x.size());
  const Eigen::ArrayXd k =
      Eigen::ArrayXd::LinSpaced(x.size(), -(count - 1.0) / 2.0, (count - 1.0) / 2.0);
  return x.mean() + (k * x).sum() / k.square().sum() * k[0];
}

// One joint of a stretch: qd and the derivative of q, both ends continued by their reflection.
struct Signal {
  Eigen::ArrayXd velocity;
  Eigen::ArrayXd position_rate;
};

// `x` with `count` samples more at each end: 2 x(end) - x(mirrored).
Eigen::ArrayXd reflected(const Eigen::ArrayXd& x, Index count, Index end) {
  const double first = 2.0 * valueAtFirst(x.head(end));
  const double last = 2.0 * valueAtFirst(x.tail(end).reverse());
  Eigen::ArrayXd result(x.size() + 2 * count);
  result << first - x.segment(1, count).reverse(), x,
      last - x.segment(x.size() - 1 - count, count).reverse();
  return result;
}

// Derivative of q: central differences, one-sided at the ends.
Eigen::ArrayXd positionRate(const Eigen::ArrayXd& q, double sampling_frequency) {
  const Index last = q.size() - 1;
  Eigen::ArrayXd rate(q.size());
  rate.segment(1, last - 1) = 0.5 * (q.tail(last - 1) - q.head(last - 1));
  rate[0] = q[1] - q[0];
  rate[last] = q[last] - q[last - 1];
  return sampling_frequency * rate;
}

// Where the segments of a signal begin; the last one ends where the signal ends.
std::vector<Index> segmentBegins(Index samples, Index length) {
  const Index spare = samples - length;
  const Index half = std::max<Index>(length / 2, 1);
  const Index steps = std::max<Index>((spare + half - 1) / half, 1);
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
  Sums(VelocitySpectra& spectra, Index padded)
      : spectra_(spectra), signal_(static_cast<std::size_t>(padded), Complex(0.0, 0.0)) {}

  // Both signals are real, so one transform of `qd + i dq` holds both: qd is its
  // conjugate-symmetric part, i dq the rest.
  void add(const Signal& signal, Index j, Index begin, const Eigen::ArrayXd& window) {
    const Index length = window.size();
    Eigen::ArrayXd velocity = signal.velocity.segment(begin, length);
    Eigen::ArrayXd position_rate = signal.position_rate.segment(begin, length);
    applyWindow(window, velocity);
    applyWindow(window, position_rate);
    std::fill(signal_.begin(), signal_.end(), Complex(0.0, 0.0));
    for (Index k = 0; k < length; ++k) {
      signal_[static_cast<std::size_t>(k)] = Complex(velocity[k], position_rate[k]);
    }
    fft_.fwd(transform_, signal_);

    const std::size_t size = transform_.size();
    for (Index i = 0; i < spectra_.frequency.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Complex here = transform_[k];
      const Complex mirrored = std::conj(transform_[(size - k) % size]);
      const Complex velocity_part = 0.5 * (here + mirrored);
      const Complex position_part = Complex(0.0, -0.5) * (here - mirrored);
      spectra_.total(i, j) += std::norm(velocity_part);
      spectra_.rate(i, j) += std::norm(position_part);
      spectra_.common(i, j) += (velocity_part * std::conj(position_part)).real();
    }
  }

 private:
  VelocitySpectra& spectra_;
  Eigen::FFT<double> fft_;
  std::vector<Complex> signal_;
  std::vector<Complex> transform_;
};

SpectrumSums::SpectrumSums(Index joints, Index longest, double sampling_frequency)
    : sampling_frequency_(sampling_frequency), length_(kLeastStretch) {
  while (static_cast<double>(2 * length_) <= kSegmentSeconds * sampling_frequency &&
         length_ < longest) {
    length_ *= 2;
  }
  const Index frequencies = length_ / 2 + 1;
  spectra_.frequency = Eigen::ArrayXd::LinSpaced(frequencies, 0.0, sampling_frequency / 2.0);
  spectra_.total = Eigen::ArrayXXd::Zero(frequencies, joints);
  spectra_.rate = Eigen::ArrayXXd::Zero(frequencies, joints);
  spectra_.common = Eigen::ArrayXXd::Zero(frequencies, joints);
  sums_ = std::make_unique<Sums>(spectra_, length_);
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
  const Index more = length / 2 - 1;
  const Index end = std::clamp<Index>(std::llround(kEndSeconds * sampling_frequency_), 3,
                                      std::max<Index>(samples / 4, 3));
  const Eigen::ArrayXd shape = hann(length);
  Eigen::ArrayXd mirrored(samples + 2 * more);
  mirrored << weight.segment(1, more).reverse(), weight,
      weight.segment(samples - 1 - more, more).reverse();
  const std::vector<Index> begins = segmentBegins(mirrored.size(), length);
  for (Index j = 0; j < stretch.qd.rows(); ++j) {
    const Signal signal = {
        reflected(stretch.qd.row(j).transpose().array(), more, end),
        reflected(positionRate(stretch.q.row(j).transpose().array(), sampling_frequency_), more,
                  end)};
    for (const Index begin : begins) {
      sums_->add(signal, j, begin, shape * mirrored.segment(begin, length));
    }
  }
}

VelocitySpectra SpectrumSums::spectra() const {
  VelocitySpectra spectra = spectra_;
  spectra.moving = samples_ > 0 ? moving_ / samples_ : 0.0;
  // a central difference passes frequency w with the gain sin(w) / w
  const Index last = spectra.frequency.size() - 1;
  for (Index i = 1; i <= last; ++i) {
    const double w = kPi * static_cast<double>(i) / static_cast<double>(last);
    const double gain = std::max(std::sin(w) / w, kLeastDifferenceGain);
    spectra.rate.row(i) /= gain * gain;
    spectra.common.row(i) /= gain;
  }
  return spectra;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
