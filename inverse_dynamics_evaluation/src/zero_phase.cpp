// SPDX-License-Identifier: Apache-2.0

#include "zero_phase.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "ends.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/low_pass.hpp"
#include "pi.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Columns = Eigen::Ref<Eigen::MatrixXd>;

constexpr int kGreatestOrder = 12;
constexpr double kFitPeriods = 1.2;     // of the cut-off, to which the ends' cubics are fitted
constexpr double kBeyondPeriods = 2.0;  // of the cut-off, by which they continue the ends

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

// y_k = b0 x_k + b1 x_(k-1) + b2 x_(k-2) - a1 y_(k-1) - a2 y_(k-2), with a gain of one at 0 Hz
struct Section {
  double b0, b1, b2, a1, a2;
};

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

// Filters columns in place, from `first` on by steps of 1 or -1, in transposed direct form II; starts
// in the steady state of the first one.
void filter(const Section& section, Columns& columns, Index first, Index step) {
  Eigen::ArrayXd one = (1.0 - section.b0) * columns.col(first).array();
  Eigen::ArrayXd two = (section.b2 - section.a2) * columns.col(first).array();
  for (Index k = first; k >= 0 && k < columns.cols(); k += step) {
    double* const column = columns.col(k).data();
    for (Index j = 0; j < one.size(); ++j) {
      const double x = column[j];
      const double y = section.b0 * x + one[j];
      one[j] = section.b1 * x - section.a1 * y + two[j];
      two[j] = section.b2 * x - section.a2 * y;
      column[j] = y;
    }
  }
}

}  // namespace

void requireFilter(double sampling_frequency, double cutoff, int order) {
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

void zeroPhase(Columns samples, double cutoff_over_sampling, int order) {
  const std::vector<Section> sections = butterworth(order, cutoff_over_sampling);
  for (const Section& section : sections) filter(section, samples, 0, 1);
  for (const Section& section : sections) filter(section, samples, samples.cols() - 1, -1);
}

void mirrorEnds(Columns samples, Index count) {
  const Index last = samples.cols() - 1 - count;
  for (Index k = 1; k <= count; ++k) {
    samples.col(count - k) = 2.0 * samples.col(count) - samples.col(count + k);
    samples.col(last + k) = 2.0 * samples.col(last) - samples.col(last - k);
  }
}

DerivativeRoom::DerivativeRoom(Index samples, double frequency, double cutoff_frequency,
                               int filter_order)
    : count(samples), sampling_frequency(frequency), cutoff(cutoff_frequency), order(filter_order) {
  const double period = sampling_frequency / cutoff;
  const auto all = static_cast<double>(count);
  fit =
      std::min(std::max(static_cast<Index>(std::min(kFitPeriods * period, all)), kLeastFit), count);
  // not further than the cubic may be trusted: as far as the samples that it is fitted to
  beyond = std::max<Index>(
      static_cast<Index>(std::min(kBeyondPeriods * period, kBeyondPeriods / kFitPeriods * all)),
      3 * (Index{order} + 1));
  mirror = defaultPadding(count + 2 * beyond, sampling_frequency, cutoff, order);
}

Columns DerivativeRoom::differentiate(Columns room) const {
  const Index first = begin();
  room.middleCols(mirror, beyond) =
      beyondEnd(room.middleCols(first, fit), beyond).rowwise().reverse();
  // the end, with time counted backwards, is a beginning
  room.middleCols(first + count, beyond) =
      beyondEnd(room.middleCols(first + count - fit, fit).rowwise().reverse(), beyond);
  mirrorEnds(room, mirror);
  zeroPhase(room, cutoff / sampling_frequency, order);
  // central differences; each takes the place of the sample two before, which no later one needs
  const double factor = sampling_frequency / 12.0;
  for (Index k = first; k < first + count; ++k) {
    room.col(k - 2) =
        factor * (8.0 * (room.col(k + 1) - room.col(k - 1)) - (room.col(k + 2) - room.col(k - 2)));
  }
  return room.middleCols(first - 2, count);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
