// SPDX-License-Identifier: Apache-2.0

#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

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

constexpr double kBlockSeconds = 0.1;
constexpr Index kAverage = 2;  // blocks to either side that are averaged
constexpr Index kMargin = 5;   // blocks to either side of a motion that count as motion
// of the variance of the noise of qd: motion power above it is motion
constexpr double kNoiseShare = 0.1;
constexpr double kStepShare = 8.0;  // of the square of q's largest step, over a block squared
constexpr double kSecondDifference = 6.0;  // variance of a second difference of white noise

// Squared second differences about the samples from `first` to `last` - 1.
struct SecondDifferences {
  Eigen::ArrayXd mean, greatest;
};

SecondDifferences secondDifferences(const Eigen::Ref<const Eigen::MatrixXd>& x, Index first,
                                    Index last) {
  SecondDifferences squares{Eigen::ArrayXd::Zero(x.rows()), Eigen::ArrayXd::Zero(x.rows())};
  for (Index k = first; k < last; ++k) {
    const Eigen::ArrayXd square = (x.col(k + 1) - 2.0 * x.col(k) + x.col(k - 1)).array().square();
    squares.mean += square / static_cast<double>(last - first);
    squares.greatest = squares.greatest.max(square);
  }
  return squares;
}

// Motion power of all joints in each block of samples, and what noise may pretend; n x B.
struct BlockPowers {
  Eigen::ArrayXXd motion;
  Eigen::ArrayXXd noise;
};

BlockPowers blockPowers(const Stretch& stretch, double sampling_frequency, Index length) {
  const Index samples = stretch.qd.cols();
  const Index blocks = std::max<Index>((samples - 1) / length, 1);
  BlockPowers powers{Eigen::ArrayXXd::Zero(stretch.qd.rows(), blocks),
                     Eigen::ArrayXXd::Zero(stretch.qd.rows(), blocks)};
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = b * length;
    const Index count = std::min(length, samples - 1 - begin);
    const Eigen::ArrayXd velocity = stretch.qd.middleCols(begin, count + 1).rowwise().mean();
    const Eigen::ArrayXd rate = (stretch.q.col(begin + count) - stretch.q.col(begin)) *
                                (sampling_frequency / static_cast<double>(count));
    powers.motion.col(b) = (velocity * rate).min(rate.square());
    const Index first = std::max<Index>(begin, 1);
    const Index last = std::max(first + 1, begin + count);
    const double seconds = static_cast<double>(count) / sampling_frequency;
    powers.noise.col(b) =
        kNoiseShare / kSecondDifference * secondDifferences(stretch.qd, first, last).mean +
        kStepShare / (seconds * seconds) * secondDifferences(stretch.q, first, last).greatest;
  }
  return powers;
}

// Means over `half` neighbours to either side, as far as there are any.
Eigen::ArrayXd averaged(const Eigen::ArrayXXd& values, Index at, Index half) {
  const Index begin = std::max<Index>(at - half, 0);
  const Index end = std::min(at + half + 1, values.cols());
  return values.middleCols(begin, end - begin).rowwise().mean();
}

// Whether the arm moves in each block: 0 to 1.
Eigen::ArrayXd movingBlocks(const BlockPowers& powers) {
  Eigen::ArrayXd moving(powers.motion.cols());
  for (Index b = 0; b < moving.size(); ++b) {
    const Eigen::ArrayXd motion = averaged(powers.motion, b, kAverage).max(0.0);
    const Eigen::ArrayXd noise = averaged(powers.noise, b, kAverage);
    // of the joint that moves most clearly; exact samples of a motion have no noise
    const Eigen::ArrayXd sum = motion.square() + noise.square();
    moving[b] = (sum > 0).select(motion.square() / sum, 0.0).maxCoeff();
  }
  return moving;
}

// Weight of each sample, 0 at rest to 1 in motion; smooth, and 1 for half a second beyond a
// motion.
//
// Over blocks of a tenth of a second, motion power is the mean velocity times the mean rate r of
// the position, and at most r^2, so that slow noise of qd isn't motion where q rests. A joint
// moves where that power, averaged over half a second, exceeds what noise may add to it: a tenth
// of the variance of the noise of qd (from second differences), and the square of the rate that a
// step of q would have if it were sqrt(8) times the largest second difference in the block. So an
// encoder that flips between two counts rests, even if a driver made qd from it. The arm moves
// where a joint does. Each weight depends on the samples within one and a half seconds only, so a
// recording of any length needs no second look.
Eigen::ArrayXd activity(const Stretch& stretch, double sampling_frequency) {
  const Index samples = stretch.qd.cols();
  const Index length = std::max<Index>(std::llround(kBlockSeconds * sampling_frequency), 1);
  const Eigen::ArrayXd moving = movingBlocks(blockPowers(stretch, sampling_frequency, length));

  // the margin beside a motion, rising and falling smoothly
  const Index blocks = moving.size();
  Eigen::ArrayXd widened(blocks);
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = std::max<Index>(b - 2 * kMargin, 0);
    const Index end = std::min(b + 2 * kMargin + 1, blocks);
    widened[b] = 0.0;
    for (Index i = begin; i < end; ++i) {
      const double beyond = std::max<double>(0.0, static_cast<double>(std::abs(i - b) - kMargin));
      const double fall = std::cos(M_PI / 2.0 * beyond / static_cast<double>(kMargin + 1));
      widened[b] = std::max(widened[b], fall * fall * moving[i]);
    }
  }

  // on straight lines between the middles of the blocks
  Eigen::ArrayXd weight(samples);
  for (Index k = 0; k < samples; ++k) {
    const double at = std::clamp((static_cast<double>(k) + 0.5) / static_cast<double>(length) - 0.5,
                                 0.0, static_cast<double>(blocks - 1));
    const auto before = std::min(static_cast<Index>(at), blocks - 1);
    const Index after = std::min(before + 1, blocks - 1);
    const double share = at - static_cast<double>(before);
    weight[k] = (1.0 - share) * widened[before] + share * widened[after];
  }
  return weight;
}

// Hann window, periodic.
Eigen::ArrayXd hann(Index length) {
  const Eigen::ArrayXd angle =
      Eigen::ArrayXd::LinSpaced(length, 0.0, static_cast<double>(length - 1)) * 2.0 * M_PI /
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
  for (Index s = 1; s <= steps; ++s) begins.push_back(s * spare / steps);
  return begins;
}

}  // namespace

SpectrumSums::SpectrumSums(Index joints, Index longest, double sampling_frequency)
    : sampling_frequency_(sampling_frequency) {
  while (static_cast<double>(2 * length_) <= kSegmentSeconds * sampling_frequency &&
         length_ < longest) {
    length_ *= 2;
  }
  signal_.resize(static_cast<std::size_t>(length_));
  divideIntoBands(length_ / 2, sampling_frequency / static_cast<double>(length_));
  spectra_.total = Eigen::ArrayXXd::Zero(spectra_.count.size(), joints);
  spectra_.rate = spectra_.common = spectra_.total;
}

// Frequencies 1 to `half` - 1 of a transform, `step` Hz apart.
void SpectrumSums::divideIntoBands(Index half, double step) {
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

void SpectrumSums::add(const Stretch& stretch) {
  const Index samples = stretch.qd.cols();
  if (samples < kLeastStretch) return;
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
      add(window * velocity.segment(begin, length), window * rate.segment(begin, length), j);
    }
  }
}

// Both signals are real, so one transform of `qd + i dq` holds both: qd is its
// conjugate-symmetric part, i dq the rest.
void SpectrumSums::add(const Eigen::ArrayXd& velocity, const Eigen::ArrayXd& rate, Index j) {
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
    const double w = 2.0 * M_PI * static_cast<double>(k) / static_cast<double>(size);
    const double gain = std::max(std::sin(w) / w, kLeastDifferenceGain);
    const Complex velocity_part = 0.5 * (here + mirrored);
    const Complex position_part = Complex(0.0, -0.5 / gain) * (here - mirrored);
    const Index band = bands_[k];
    spectra_.total(band, j) += std::norm(velocity_part);
    spectra_.rate(band, j) += std::norm(position_part);
    spectra_.common(band, j) += (velocity_part * std::conj(position_part)).real();
  }
}

VelocitySpectra SpectrumSums::spectra() const {
  VelocitySpectra spectra = spectra_;
  spectra.moving = samples_ > 0 ? moving_ / samples_ : 0.0;
  return spectra;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
