// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/low_pass.hpp"

#include <algorithm>
#include <cmath>

#include "checks.hpp"
#include "pi.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

double lowPassGain(double frequency, double cutoff, double sampling_frequency, int order) {
  if (frequency >= sampling_frequency / 2) {
    return 0.0;
  }
  const double ratio =
      std::tan(kPi * frequency / sampling_frequency) / std::tan(kPi * cutoff / sampling_frequency);
  return 1.0 / (1.0 + std::pow(ratio * ratio, order));
}

Eigen::Index defaultPadding(Eigen::Index samples, double sampling_frequency, double cutoff,
                            int order) {
  const double periods = std::ceil(1.5 * sampling_frequency / cutoff);
  const auto least = static_cast<double>(3 * (order + 1));
  const auto available = static_cast<double>(samples - 1);
  return static_cast<Eigen::Index>(std::min(std::max(periods, least), available));
}

OwnedMatrix lowPass(const Eigen::Ref<const Eigen::MatrixXd>& samples, double sampling_frequency,
                    double cutoff, int order, Eigen::Index padding) {
  requireFilter(sampling_frequency, cutoff, order);
  requireSamples("low-pass", "samples", samples, leastSamples(order));
  requireFinite("low-pass", "samples", samples);
  const Eigen::Index count = samples.cols();
  if (padding >= count) {
    throw EvaluationError("low-pass", "padding", "fewer than " + std::to_string(count) + " samples",
                          std::to_string(padding), "leave it out");
  }
  const Eigen::Index pad =
      padding < 0 ? defaultPadding(count, sampling_frequency, cutoff, order) : padding;

  Eigen::MatrixXd extended(samples.rows(), count + 2 * pad);
  extended.middleCols(pad, count) = samples;
  mirrorEnds(extended, pad);
  zeroPhase(extended, cutoff / sampling_frequency, order);
  return extended.middleCols(pad, count);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
