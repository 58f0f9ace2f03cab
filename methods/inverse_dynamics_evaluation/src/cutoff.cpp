// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/cutoff.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "checks.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "spectrum.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr int kCandidates = 100;     // cut-offs tried, in equal ratios of 3 to 8 %
constexpr double kHighest = 0.4;     // of the sampling frequency: the filter needs some beyond
constexpr double kLowest = 0.25;     // Hz: no arm's motion is slower on purpose
constexpr double kPeriods = 2.0;     // of the lowest cut-off, in the recording
constexpr double kUpper = 0.5;       // of all frequencies: above it q has nothing but noise
constexpr double kNear = 1.4142136;  // frequencies within half an octave are averaged
constexpr double kOctave = 2.0;
// of the power of the derivative of q, noise: above, q says little. Where stamps are irregular,
// interpolation leaves a third of the noise at high frequencies.
constexpr double kNoisy = 0.2;
constexpr double kMotion = 0.99;    // of the power of the velocities is motion's
constexpr double kCoherent = 0.25;  // qd has the noise of q, late by up to 60 degrees: cos^2

// Share of white noise of q in the power of a joint's derivative of q; B. Its level is that of the
// upper half of the frequencies.
Eigen::ArrayXd noiseShare(const VelocitySpectra& spectra, Eigen::Index j) {
  const Eigen::ArrayXd& f = spectra.frequency;
  const Eigen::ArrayXd white = spectra.count * f.square();
  const auto rate = spectra.rate.col(j);
  const Eigen::ArrayXd upper = (f > kUpper * f.maxCoeff()).cast<double>();
  const double level = (upper * rate).sum() / (upper * white).sum();
  return f.unaryExpr([&](double at) -> double {
    const Eigen::ArrayXd near = (f > at / kNear && f < at * kNear).cast<double>();
    const double power = (near * rate).sum();
    return power > 0 ? std::min(level * (near * white).sum() / power, 1.0) : 1.0;
  });
}

// Motion's power of a joint's qd, as q confirms it; B. The octave above the last frequency at which
// q is mostly motion tells whether qd has the noise of q.
Eigen::ArrayXd confirmedMotion(const VelocitySpectra& spectra, Eigen::Index j) {
  const Eigen::ArrayXd& f = spectra.frequency;
  const Eigen::ArrayXd noise = noiseShare(spectra, j);
  const double last = (noise < kNoisy).select(f, 0.0).maxCoeff();
  const Eigen::ArrayXd octave = (f > last && f < kOctave * last).cast<double>();
  const double common = (octave * spectra.common.col(j)).sum();
  const double total = (octave * spectra.total.col(j)).sum();
  const double rate = (octave * spectra.rate.col(j)).sum();
  if (common * common < kCoherent * total * rate) {
    return (f < kOctave * last).select(spectra.common.col(j), 0.0);
  }
  return (f <= last).select(spectra.common.col(j) * (1.0 - noise), 0.0);
}

// The candidate with the least expected squared error of acceleration, all joints together.
double leastError(const VelocitySpectra& spectra, const Eigen::ArrayXd& candidates,
                  double sampling_frequency, int order) {
  const Eigen::ArrayXd total = spectra.total.rowwise().sum();
  Eigen::ArrayXd confirmed = Eigen::ArrayXd::Zero(total.size());
  for (Eigen::Index j = 0; j < spectra.total.cols(); ++j) {
    // steps of a coarse q have common power with the noise of qd, by chance and more than its own
    confirmed += confirmedMotion(spectra, j).min(spectra.total.col(j));
  }
  double best = candidates[0];
  double least = std::numeric_limits<double>::infinity();
  for (const double cutoff : candidates) {
    const Eigen::ArrayXd h = spectra.frequency.unaryExpr(
        [&](double f) { return lowPassGain(f, cutoff, sampling_frequency, order); });
    // motion lost plus noise let through
    const double expected = (spectra.frequency.square() *
                             ((1.0 - h).square() * confirmed + h.square() * (total - confirmed)))
                                .sum();
    if (expected < least) {
      least = expected;
      best = cutoff;
    }
  }
  return best;
}

// The frequency below which nearly all of the velocities' power lies, each joint with the same weight.
double motionFrequency(const VelocitySpectra& spectra) {
  Eigen::ArrayXd power = Eigen::ArrayXd::Zero(spectra.frequency.size());
  for (Eigen::Index j = 0; j < spectra.total.cols(); ++j) {
    const double all = spectra.total.col(j).sum();
    if (all > 0) power += spectra.total.col(j) / all;
  }
  double below = 0;
  for (Eigen::Index b = 0; b < power.size(); ++b) {
    below += power[b];
    if (below >= kMotion * power.sum()) return spectra.frequency[b];
  }
  return 0;
}

}  // namespace

void requireLongEnough(Eigen::Index longest) {
  if (longest < kLeastStretch) {
    throw EvaluationError("cut-off", "samples",
                          std::to_string(kLeastStretch) + " or more without a gap",
                          std::to_string(longest), "give a cut-off, or take raw differences");
  }
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
  // where no velocity ever changes there is nothing to take away
  choice.cutoff = spectra.total.isZero(0)
                      ? choice.highest
                      : leastError(spectra, candidates, sampling_frequency, order);
  choice.by_motion = choice.cutoff;
  choice.motion = motionFrequency(spectra);
  return choice;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
