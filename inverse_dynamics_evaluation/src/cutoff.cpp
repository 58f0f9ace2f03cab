// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/cutoff.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "checks.hpp"
#include "pi.hpp"
#include "quantile.hpp"
#include "spectrum.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr int kCandidates = 100;        // cut-offs tried, in equal ratios
constexpr double kHighest = 0.4;        // of the sampling frequency
constexpr double kLowest = 0.25;        // Hz
constexpr double kPeriods = 2.0;        // of the lowest cut-off, in the recording
constexpr double kMostOfMotion = 0.9;   // of the power: the plateau is looked for above it
constexpr double kPlateauBegin = 1.25;  // of a cut-off: the noise right above it
constexpr double kPlateauEnd = 2.5;     // of a cut-off
constexpr double kSlowFall = 0.25;      // in an octave: noise behind a filter of first order
// of the noisiest joint's power: what a joint may be weighed by
constexpr double kLeastNoise = 1e-4;
constexpr int kNoiseBands = 8;          // of high frequencies, where q has white noise
constexpr double kLowestBand = 0.125;   // of half the sampling frequency
constexpr double kHighestBand = 0.9;    // the same
constexpr double kQuietBands = 0.25;    // of the bands, at least, have nothing but noise
constexpr double kSmoothing = 0.1;      // of a frequency to either side, in an average
constexpr Eigen::Index kLeastBins = 2;  // frequencies to either side in an average
constexpr double kMostly = 0.5;         // of a power
constexpr int kCoherenceBands = 4;      // in which qd may have the noise of q
constexpr double kBandWidth = 0.5;      // octaves

// Spectra of all joints in one.
struct JointSum {
  Eigen::ArrayXd frequency;
  Eigen::ArrayXd total;   // power of qd
  Eigen::ArrayXd rate;    // power of the derivative of q
  Eigen::ArrayXd common;  // what both share
};

double median(Eigen::ArrayXd values) {
  double* middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

// What each joint's spectra are multiplied by: one over its level in the upper half of the
// frequencies; 0 for a joint that never moves.
Eigen::ArrayXd jointWeights(const VelocitySpectra& spectra) {
  const Eigen::Index upper = spectra.frequency.size() / 2;
  Eigen::ArrayXd level(spectra.total.cols());
  for (Eigen::Index j = 0; j < level.size(); ++j) {
    level[j] = median(spectra.total.col(j).tail(upper));
  }
  const double least = kLeastNoise * level.maxCoeff();
  return (level > 0).select(1.0 / level.max(least), 0.0);
}

JointSum sumOfJoints(const VelocitySpectra& spectra, const Eigen::ArrayXd& weights) {
  return {spectra.frequency, (spectra.total.matrix() * weights.matrix()).array(),
          (spectra.rate.matrix() * weights.matrix()).array(),
          (spectra.common.matrix() * weights.matrix()).array()};
}

// lowPassGain() at all frequencies of the spectra.
class Gains {
 public:
  Gains(const Eigen::ArrayXd& frequency, double sampling_frequency, int order)
      : sampling_frequency_(sampling_frequency),
        order_(order),
        square_((kPi / sampling_frequency * frequency).tan().square()) {}

  /// At the first `count` frequencies.
  Eigen::ArrayXd operator()(double cutoff, Eigen::Index count) const {
    const double square = std::pow(std::tan(kPi * cutoff / sampling_frequency_), 2);
    const Eigen::ArrayXd ratio = square_.head(count) / square;
    Eigen::ArrayXd power = ratio;
    for (int i = 1; i < order_; ++i) {
      power *= ratio;
    }
    return 1.0 / (1.0 + power);
  }
  Eigen::ArrayXd operator()(double cutoff) const { return (*this)(cutoff, square_.size()); }

 private:
  double sampling_frequency_;
  int order_;
  Eigen::ArrayXd square_;  // of tan(pi f / f_s)
};

// Averages over neighbouring frequencies.
Eigen::ArrayXd smoothed(const Eigen::ArrayXd& power) {
  const Eigen::Index count = power.size();
  Eigen::ArrayXd before(count + 1);  // sums
  before[0] = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    before[i + 1] = before[i] + power[i];
  }
  Eigen::ArrayXd result(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index half =
        std::max(static_cast<Eigen::Index>(kSmoothing * static_cast<double>(i)), kLeastBins);
    const Eigen::Index begin = std::clamp<Eigen::Index>(i - half, 1, count - 1);
    const Eigen::Index end = std::min(i + half + 1, count);
    result[i] = (before[end] - before[begin]) / static_cast<double>(end - begin);
  }
  return result;
}

// Which share of the power of the derivative of q is white noise of q: f^2 times its level.
Eigen::ArrayXd noiseOfRate(const JointSum& sum) {
  const auto last = static_cast<double>(sum.frequency.size() - 1);
  const auto edge = [&](int band) {
    const double share = kLowestBand + (kHighestBand - kLowestBand) * band / kNoiseBands;
    return std::max<Eigen::Index>(static_cast<Eigen::Index>(share * last), 1);
  };
  std::vector<double> levels;
  for (int band = 0; band < kNoiseBands; ++band) {
    const Eigen::Index count = std::max<Eigen::Index>(edge(band + 1) - edge(band), 1);
    levels.push_back(
        (sum.rate.segment(edge(band), count) / sum.frequency.segment(edge(band), count).square())
            .mean());
  }
  const Eigen::ArrayXd rate = smoothed(sum.rate).max(std::numeric_limits<double>::min());
  return (quantile(levels, kQuietBands) * sum.frequency.square() / rate).min(1.0);
}

// Whether qd has the noise of q: whether both are coherent in a band from `begin` on, where q is
// mostly noise. Independent noise leaves less than half of the coherence there.
bool sharesNoise(const JointSum& sum, Eigen::Index begin) {
  const Eigen::Index last = sum.frequency.size();
  for (int band = 0; band < kCoherenceBands; ++band) {
    const auto edge = [&](int number) {
      const double bin = std::ceil(static_cast<double>(begin) * std::exp2(kBandWidth * number));
      return std::min(static_cast<Eigen::Index>(bin), last);
    };
    const Eigen::Index count = edge(band + 1) - edge(band);
    if (count <= kLeastBins) {
      continue;
    }
    const double common = sum.common.segment(edge(band), count).sum();
    if (common > 0 && common * common > kMostly * sum.total.segment(edge(band), count).sum() *
                                            sum.rate.segment(edge(band), count).sum()) {
      return true;
    }
  }
  return false;
}

// Motion's share of the power of qd, as q confirms it.
Eigen::ArrayXd confirmedMotion(const JointSum& sum) {
  const Eigen::ArrayXd noise = noiseOfRate(sum);
  Eigen::Index begin = 1;  // of the frequencies where q is mostly noise
  while (begin < noise.size() && noise[begin] <= kMostly) {
    ++begin;
  }
  if (begin == noise.size() || !sharesNoise(sum, begin)) {
    return sum.common;
  }
  Eigen::ArrayXd motion = sum.total * (1.0 - noise);
  motion.tail(motion.size() - begin).setZero();
  return motion;
}

// The candidate with the least expected squared error of acceleration.
double byAgreement(const JointSum& sum, const Eigen::ArrayXd& candidates, const Gains& gains) {
  const Eigen::ArrayXd confirmed = confirmedMotion(sum);
  const Eigen::ArrayXd motion = sum.frequency.square() * confirmed;
  const Eigen::ArrayXd noise = sum.frequency.square() * (sum.total - confirmed);
  double best = candidates[0];
  double least = std::numeric_limits<double>::infinity();
  for (const double cutoff : candidates) {
    // motion lost plus noise let through
    const Eigen::ArrayXd h = gains(cutoff);
    const double expected = ((1.0 - h).square() * motion + h.square() * noise).sum();
    if (expected < least) {
      least = expected;
      best = cutoff;
    }
  }
  return best;
}

// The lowest candidate, above most of the motion, at which noise as strong as right above it
// outweighs the motion lost.
double byPlateau(const JointSum& sum, const Eigen::ArrayXd& candidates, double sampling_frequency,
                 const Gains& gains) {
  const Eigen::Index last = sum.frequency.size() - 1;
  const double step = sum.frequency[last] / static_cast<double>(last);
  const auto at = [&](double frequency) {
    return std::min(static_cast<Eigen::Index>(std::ceil(frequency / step)), last);
  };
  Eigen::Index most = 0;  // below it lies most of the power
  for (double below = 0.0; below < kMostOfMotion * sum.total.sum() && most < last; ++most) {
    below += sum.total[most];
  }
  // mean power of some multiples of a cut-off
  const auto power = [&](double cutoff, double from, double to) {
    const Eigen::Index begin = std::min(at(from * cutoff), last);
    return sum.total.segment(begin, std::max<Eigen::Index>(at(to * cutoff) - begin, 1)).mean();
  };
  for (const double cutoff : candidates) {
    if (cutoff < sum.frequency[std::max<Eigen::Index>(most - 1, 0)]) {
      continue;
    }
    if (kPlateauEnd * cutoff > sampling_frequency / 2) {
      break;
    }
    const double noise = power(cutoff, kPlateauBegin, kPlateauEnd);
    if (power(cutoff, kPlateauEnd, 2.0 * kPlateauEnd) < kSlowFall * noise) {
      continue;  // still motion
    }
    const Eigen::Index count = at(kPlateauBegin * cutoff);
    const Eigen::ArrayXd f2 = sum.frequency.head(count).square();
    const Eigen::ArrayXd h = gains(cutoff, count);
    const Eigen::ArrayXd motion = (sum.total.head(count) - noise).max(0.0);
    if ((f2 * (1.0 - h).square() * motion).sum() < (f2 * h.square()).sum() * noise) {
      return cutoff;
    }
  }
  return candidates[candidates.size() - 1];
}

void checkStretches(const std::vector<Stretch>& stretches) {
  for (const Stretch& stretch : stretches) {
    requireSameSize("cut-off", "q", stretch.q, "qd", stretch.qd);
    requireFinite("cut-off", "q", stretch.q);
    requireFinite("cut-off", "qd", stretch.qd);
    if (stretch.qd.rows() != stretches.front().qd.rows()) {
      throw EvaluationError("cut-off", "stretches", "the same joints in all", "different numbers",
                            "choose a cut-off for each robot");
    }
  }
}

}  // namespace

void requireLongEnough(Eigen::Index longest) {
  if (longest < kLeastStretch) {
    throw EvaluationError("cut-off", "samples",
                          std::to_string(kLeastStretch) + " or more without a gap",
                          std::to_string(longest), "give a cut-off, or take raw differences");
  }
}

CutoffChoice chooseCutoff(const std::vector<Stretch>& stretches, double sampling_frequency,
                          int order) {
  checkStretches(stretches);
  Eigen::Index longest = 0;
  for (const Stretch& stretch : stretches) {
    longest = std::max(longest, stretch.qd.cols());
  }
  requireLongEnough(longest);
  SpectrumSums sums(stretches.front().qd.rows(), longest, sampling_frequency);
  for (const Stretch& stretch : stretches) {
    sums.add(stretch);
  }
  const double duration = static_cast<double>(longest - 1) / sampling_frequency;
  return cutoffOf(sums.spectra(), duration, sampling_frequency, order);
}

CutoffChoice cutoffOf(const VelocitySpectra& spectra, double duration, double sampling_frequency,
                      int order) {
  // cut-offs to choose from, in equal ratios
  CutoffChoice choice;
  choice.highest = kHighest * sampling_frequency;
  choice.lowest = std::min(std::max(kLowest, kPeriods / duration), choice.highest);
  const Eigen::ArrayXd candidates =
      Eigen::ArrayXd::LinSpaced(kCandidates, std::log(choice.lowest), std::log(choice.highest))
          .exp();

  choice.moving = spectra.moving;
  const Eigen::ArrayXd weights = jointWeights(spectra);
  if (weights.isZero(0)) {  // no velocity ever changes: nothing to take away
    choice.agreement = choice.plateau = choice.cutoff = choice.highest;
    return choice;
  }
  const JointSum sum = sumOfJoints(spectra, weights);
  const Gains gains(spectra.frequency, sampling_frequency, order);
  choice.agreement = byAgreement(sum, candidates, gains);
  choice.plateau = byPlateau(sum, candidates, sampling_frequency, gains);
  choice.cutoff = std::min(choice.agreement, choice.plateau);
  return choice;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
