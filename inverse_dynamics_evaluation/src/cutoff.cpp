// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/cutoff.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "checks.hpp"
#include "inverse_dynamics_evaluation/low_pass.hpp"
#include "spectrum.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr Eigen::Index kLeastSamples = 16;
constexpr int kCandidates = 100;    // cut-offs tried, in equal ratios
constexpr int kLinePoints = 15;     // of the straight line of the residual
constexpr double kLineBegin = 0.3;  // of the sampling frequency
constexpr double kLineEnd = 0.4;    // of the sampling frequency: also the highest cut-off
constexpr double kLowest = 0.25;    // Hz
constexpr double kPeriods = 2.0;    // of the lowest cut-off, in the recording
constexpr double kLeastNoise =
    1e-4;  // of the noisiest joint's power: what a joint may be weighed by

// Spectra of all joints in one: each divided by its level in the upper half of the frequencies.
struct JointSum {
  Eigen::ArrayXd frequency;
  Eigen::ArrayXd total;   // power of qd
  Eigen::ArrayXd common;  // the share of it that q confirms: motion
  bool moves = false;     // whether there is any power at all
};

double median(Eigen::ArrayXd values) {
  double* middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

JointSum sumOfJoints(const VelocitySpectra& spectra) {
  const Eigen::Index upper = spectra.frequency.size() / 2;
  Eigen::ArrayXd level(spectra.total.cols());
  for (Eigen::Index j = 0; j < level.size(); ++j) {
    level[j] = median(spectra.total.col(j).tail(upper));
  }
  const double least = kLeastNoise * level.maxCoeff();

  JointSum sum{spectra.frequency, Eigen::ArrayXd::Zero(spectra.frequency.size()),
               Eigen::ArrayXd::Zero(spectra.frequency.size()), false};
  for (Eigen::Index j = 0; j < level.size(); ++j) {
    if (level[j] > 0) {
      sum.total += spectra.total.col(j) / std::max(level[j], least);
      sum.common += spectra.common.col(j) / std::max(level[j], least);
      sum.moves = true;
    }
  }
  return sum;
}

Eigen::ArrayXd gains(const Eigen::ArrayXd& frequency, double cutoff, double sampling_frequency,
                     int order) {
  return frequency.unaryExpr(
      [&](double f) { return lowPassGain(f, cutoff, sampling_frequency, order); });
}

// The candidate with the least expected squared error of acceleration.
double byAgreement(const JointSum& sum, const Eigen::ArrayXd& candidates, double sampling_frequency,
                   int order) {
  const Eigen::ArrayXd motion = sum.frequency.square() * sum.common;
  const Eigen::ArrayXd noise = sum.frequency.square() * (sum.total - sum.common);
  double best = candidates[0];
  double least = std::numeric_limits<double>::infinity();
  for (const double cutoff : candidates) {
    // motion lost plus noise let through
    const Eigen::ArrayXd h = gains(sum.frequency, cutoff, sampling_frequency, order);
    const double expected = ((1.0 - h).square() * motion + h.square() * noise).sum();
    if (expected < least) {
      least = expected;
      best = cutoff;
    }
  }
  return best;
}

// The lowest candidate at which the residual is down to the level of the noise.
double byResidual(const JointSum& sum, const Eigen::ArrayXd& candidates, double sampling_frequency,
                  int order) {
  const auto residual = [&](double cutoff) {
    const Eigen::ArrayXd h = gains(sum.frequency, cutoff, sampling_frequency, order);
    return std::sqrt(((1.0 - h).square() * sum.total).sum());
  };
  // straight line of least squares, extended to a cut-off of zero
  const Eigen::ArrayXd x = Eigen::ArrayXd::LinSpaced(kLinePoints, kLineBegin, kLineEnd);
  const Eigen::ArrayXd y =
      x.unaryExpr([&](double share) { return residual(share * sampling_frequency); });
  const double slope = ((x - x.mean()) * y).sum() / (x - x.mean()).square().sum();
  const double level = y.mean() - slope * x.mean();
  for (const double cutoff : candidates) {
    if (residual(cutoff) <= level) {
      return cutoff;
    }
  }
  return candidates[candidates.size() - 1];
}

void checkStretches(const std::vector<Stretch>& stretches) {
  Eigen::Index longest = 0;
  for (const Stretch& stretch : stretches) {
    requireSameSize("cut-off", "q", stretch.q, "qd", stretch.qd);
    requireFinite("cut-off", "q", stretch.q);
    requireFinite("cut-off", "qd", stretch.qd);
    if (stretch.qd.rows() != stretches.front().qd.rows()) {
      throw EvaluationError("cut-off", "stretches", "the same joints in all", "different numbers",
                            "choose a cut-off for each robot");
    }
    longest = std::max(longest, stretch.qd.cols());
  }
  if (longest < kLeastSamples) {
    throw EvaluationError("cut-off", "samples",
                          std::to_string(kLeastSamples) + " or more without a gap",
                          std::to_string(longest), "give a cut-off, or take raw differences");
  }
}

}  // namespace

CutoffChoice chooseCutoff(const std::vector<Stretch>& stretches, double sampling_frequency,
                          int order) {
  checkStretches(stretches);
  Eigen::Index longest = 0;
  for (const Stretch& stretch : stretches) {
    longest = std::max(longest, stretch.qd.cols());
  }

  // cut-offs to choose from, in equal ratios
  CutoffChoice choice;
  const double duration = static_cast<double>(longest - 1) / sampling_frequency;
  choice.highest = kLineEnd * sampling_frequency;
  choice.lowest = std::min(std::max(kLowest, kPeriods / duration), choice.highest);
  const Eigen::ArrayXd candidates =
      Eigen::ArrayXd::LinSpaced(kCandidates, std::log(choice.lowest), std::log(choice.highest))
          .exp();

  const JointSum sum = sumOfJoints(velocitySpectra(stretches, sampling_frequency));
  if (!sum.moves) {  // no velocity ever changes: nothing to take away
    choice.agreement = choice.residual = choice.highest;
  } else {
    choice.agreement = byAgreement(sum, candidates, sampling_frequency, order);
    choice.residual = byResidual(sum, candidates, sampling_frequency, order);
  }
  choice.cutoff = std::min(choice.agreement, choice.residual);
  return choice;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
