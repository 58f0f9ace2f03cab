// SPDX-License-Identifier: Apache-2.0

#include "zero_phase.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "inverse_dynamics_evaluation/error.hpp"
#include "pi.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr int kGreatestOrder = 12;
constexpr Index kLeastBlock = 512;        // samples
constexpr double kBits = 60.0;            // of a wrong start's error that must be gone
constexpr double kBitsPerSection = 4.0;   // for the constants of the bound
constexpr double kSlowest = 1.0 - 1e-15;  // a pole beyond is 1, and its filter forgets nothing

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
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

ZeroPhaseFilter::ZeroPhaseFilter(Index joints, double cutoff_over_sampling, int order,
                                 Index overlap, TakeColumns take)
    : sections_(butterworth(order, cutoff_over_sampling)),
      overlap_(overlap),
      take_(std::move(take)),
      waiting_(joints, 0) {}

// Pairs of complex poles as sections of second order, the real pole of an odd order as a first one.
// Analog poles lie on a circle of radius w_c; the bilinear transformation s = (z - 1) / (z + 1)
// with w_c = tan(pi f_c / f_s) takes them to the digital filter.
std::vector<ZeroPhaseFilter::Section> ZeroPhaseFilter::butterworth(int order,
                                                                   double cutoff_over_sampling) {
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

Index ZeroPhaseFilter::overlapOf(double cutoff_over_sampling, int order) {
  const std::vector<Section> sections = butterworth(order, cutoff_over_sampling);
  double slowest = 0.0;
  for (const Section& section : sections) {
    // |z|^2 of a complex pair is a2; a first order has its pole at -a1
    slowest = std::max(slowest, section.b2 != 0 ? std::sqrt(section.a2) : std::abs(section.a1));
  }
  const double fall = -std::log(std::min(slowest, kSlowest));
  const auto count = static_cast<double>(sections.size());
  const double bits = std::log(2.0) * (kBits + kBitsPerSection * count);
  double overlap = bits / fall;
  for (int i = 0; i < 50; ++i) {  // (m + 1)^(2 s) r^m = 2^-bits, by iteration from below
    overlap = (bits + 2.0 * count * std::log(overlap + 1.0)) / fall;
  }
  constexpr double kMost = 1e15;  // no recording is as long
  return static_cast<Index>(std::ceil(std::min(overlap, kMost)));
}

ZeroPhaseFilter::State ZeroPhaseFilter::steady(const Section& section,
                                               const Eigen::Ref<const Eigen::VectorXd>& value) {
  return {(1.0 - section.b0) * value.array(), (section.b2 - section.a2) * value.array()};
}

void ZeroPhaseFilter::filterColumn(const Section& section, State& state, double* column) {
  for (Index j = 0; j < state.first.size(); ++j) {
    const double x = column[j];
    const double y = section.b0 * x + state.first[j];
    state.first[j] = section.b1 * x - section.a1 * y + state.second[j];
    state.second[j] = section.b2 * x - section.a2 * y;
    column[j] = y;
  }
}

void ZeroPhaseFilter::reserve(Index more) {
  if (count_ + more > waiting_.cols()) {
    waiting_.conservativeResize(Eigen::NoChange, std::max(count_ + more, 2 * waiting_.cols()));
  }
}

void ZeroPhaseFilter::push(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const bool whole = overlap_ == kWhole;
  const Index block = std::max(overlap_, kLeastBlock);
  for (Index begin = 0; begin < samples.cols();) {
    const Index count =
        std::min(samples.cols() - begin, whole ? samples.cols() : block + overlap_ - count_);
    reserve(count);
    waiting_.middleCols(count_, count) = samples.middleCols(begin, count);
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      if (forwards_.size() == s) {
        forwards_.push_back(steady(sections_[s], waiting_.col(0)));
      }
      for (Index k = 0; k < count; ++k) {
        filterColumn(sections_[s], forwards_[s], waiting_.col(count_ + k).data());
      }
    }
    count_ += count;
    begin += count;
    if (!whole && count_ == block + overlap_) {
      backwards(block);
    }
  }
}

void ZeroPhaseFilter::finish() {
  if (count_ > 0) {
    backwards(count_);
  }
}

// Filters what waits backwards from its end, and gives the first of it.
void ZeroPhaseFilter::backwards(Index give) {
  Eigen::MatrixXd filtered = waiting_.leftCols(count_);
  for (const Section& section : sections_) {
    State state = steady(section, filtered.col(count_ - 1));
    for (Index k = count_ - 1; k >= 0; --k) {
      filterColumn(section, state, filtered.col(k).data());
    }
  }
  const Index rest = count_ - give;
  waiting_.leftCols(rest) = waiting_.middleCols(give, rest).eval();
  count_ = rest;
  take_(filtered.leftCols(give));
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
