// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/low_pass.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "checks.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kGreatestOrder = 12;

// y_k = b0 x_k + b1 x_(k-1) + b2 x_(k-2) - a1 y_(k-1) - a2 y_(k-2), with a gain of one at 0 Hz
struct Section {
  double b0, b1, b2, a1, a2;
};

Eigen::Index leastSamples(int order) { return 3 * (order + 1) + 1; }

// Pairs of complex poles as sections of second order, the real pole of an odd order as a first one.
// Analog poles lie on a circle of radius w_c; the bilinear transformation s = (z - 1) / (z + 1)
// with w_c = tan(pi f_c / f_s) takes them to the digital filter.
std::vector<Section> butterworth(int order, double cutoff_over_sampling) {
  const double w = std::tan(kPi * cutoff_over_sampling);
  std::vector<Section> sections;
  for (int i = 0; i < order / 2; ++i) {
    // s^2 + 2 cos(theta) w s + w^2, theta the angle of the pole to the negative real axis
    const double theta = kPi * (order - 1 - 2 * i) / (2.0 * order);
    const double damping = 2.0 * std::cos(theta) * w;
    const double a0 = 1.0 + damping + w * w;
    const double b = w * w / a0;
    sections.push_back({b, 2.0 * b, b, 2.0 * (w * w - 1.0) / a0, (1.0 - damping + w * w) / a0});
  }
  if (order % 2 == 1) {
    const double b = w / (1.0 + w);
    sections.push_back({b, b, 0.0, (w - 1.0) / (w + 1.0), 0.0});
  }
  return sections;
}

// One section over all columns, in place, in the order first, first + step, ... (count of them).
// Transposed direct form II; starts in the steady state of the first value.
void filterColumns(const Section& section, Eigen::Index first, Eigen::Index step,
                   Eigen::MatrixXd& samples) {
  const Eigen::Index joints = samples.rows();
  Eigen::ArrayXd state_1 = (1.0 - section.b0) * samples.col(first).array();
  Eigen::ArrayXd state_2 = (section.b2 - section.a2) * samples.col(first).array();
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    double* column = samples.col(first + i * step).data();
    for (Eigen::Index j = 0; j < joints; ++j) {
      const double x = column[j];
      const double y = section.b0 * x + state_1[j];
      state_1[j] = section.b1 * x - section.a1 * y + state_2[j];
      state_2[j] = section.b2 * x - section.a2 * y;
      column[j] = y;
    }
  }
}

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

void checkFilter(double sampling_frequency, double cutoff, int order) {
  if (!(sampling_frequency > 0) || !std::isfinite(sampling_frequency)) {
    throw EvaluationError("low-pass", "sampling frequency", "a positive number of Hz",
                          text(sampling_frequency), "give samples per second");
  }
  if (!(cutoff > 0) || !(cutoff < sampling_frequency / 2)) {
    throw EvaluationError(
        "low-pass", "cut-off",
        "above 0 and below half the sampling frequency, " + text(sampling_frequency / 2) + " Hz",
        text(cutoff) + " Hz", "lower it, or don't filter");
  }
  if (order < 1 || order > kGreatestOrder) {
    throw EvaluationError("low-pass", "order", "1 to " + std::to_string(kGreatestOrder),
                          std::to_string(order), "2 is usual");
  }
}

}  // namespace

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
  checkFilter(sampling_frequency, cutoff, order);
  requireSamples("low-pass", "samples", samples, leastSamples(order));
  requireFinite("low-pass", "samples", samples);
  const Eigen::Index count = samples.cols();
  if (padding >= count) {
    throw EvaluationError("low-pass", "padding", "fewer than " + std::to_string(count) + " samples",
                          std::to_string(padding), "leave it out");
  }
  const Eigen::Index pad =
      padding < 0 ? defaultPadding(count, sampling_frequency, cutoff, order) : padding;

  // continue both ends by their point reflection: 2 x_0 - x_k
  Eigen::MatrixXd extended(samples.rows(), count + 2 * pad);
  extended.middleCols(pad, count) = samples;
  for (Eigen::Index k = 1; k <= pad; ++k) {
    extended.col(pad - k) = 2.0 * samples.col(0) - samples.col(k);
    extended.col(pad + count - 1 + k) = 2.0 * samples.col(count - 1) - samples.col(count - 1 - k);
  }

  // forwards through all sections, then backwards
  const std::vector<Section> sections = butterworth(order, cutoff / sampling_frequency);
  for (const Section& section : sections) {
    filterColumns(section, 0, 1, extended);
  }
  for (const Section& section : sections) {
    filterColumns(section, extended.cols() - 1, -1, extended);
  }
  return extended.middleCols(pad, count);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
