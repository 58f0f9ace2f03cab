// SPDX-License-Identifier: Apache-2.0

#include "resampler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// Distances of samples that a cubic may run through, in periods: across a longer hole, the noise of
// the two samples at either end would set its slope.
constexpr double kLeastApart = 0.5;
constexpr double kMostApart = 3.0;
constexpr Index kGivenAtOnce = 4096;

// Weights of four samples at the instants `at` in the cubic through them, at instant t.
Eigen::Vector4d cubicWeights(const Eigen::Vector4d& at, double t) {
  Eigen::Vector4d weights = Eigen::Vector4d::Ones();
  for (Index i = 0; i < 4; ++i) {
    for (Index k = 0; k < 4; ++k) {
      weights[i] *= i == k ? 1.0 : (t - at[k]) / (at[i] - at[k]);
    }
  }
  return weights;
}

}  // namespace

Grid::Grid(const Piece& piece, double usual_period) : Piece(piece) {
  const double duration = end - begin;
  count = std::max(static_cast<Index>(std::llround(duration / usual_period)) + 1, used);
  period = duration / static_cast<double>(count - 1);
}

Resampler::Resampler(const Grid& grid, Index rows, TakeColumns take)
    : grid_(grid),
      take_(std::move(take)),
      numbers_(rows, 4),
      values_(rows, std::min(kGivenAtOnce, grid.count)) {}

void Resampler::add(double instant, const double* numbers) {
  const Index rows = numbers_.rows();
  std::copy_n(instants_.data() + 1, 3, instants_.data());
  std::copy_n(numbers_.data() + rows, 3 * rows, numbers_.data());
  instants_[3] = instant;
  std::copy_n(numbers, rows, numbers_.data() + 3 * rows);
  const bool last = ++added_ == grid_.used;
  if (added_ < 4) {
    return;
  }
  if (added_ > 4) {  // what lies before the second of the four has been made
    right_ = std::max(right_, added_ - 2);
  }
  // an instant needs a sample more than the two around it, where there is one
  while (made_ < grid_.count) {
    const double t = grid_.begin + static_cast<double>(made_) * grid_.period;
    if (!last && t > instants_[2]) {
      break;
    }
    giveValue(t);
  }
  if (last) {
    flush();
  }
}

void Resampler::giveValue(double t) {
  const Index first = added_ - 4;  // number of the first of the four
  while (right_ + 1 < grid_.used && instants_[right_ - first] < t) {
    ++right_;
  }
  const Eigen::Vector3d apart = (instants_.tail<3>() - instants_.head<3>()) / grid_.period;
  auto value = values_.col(waiting_);
  if (apart.minCoeff() >= kLeastApart && apart.maxCoeff() <= kMostApart) {
    const Eigen::Vector4d weights = cubicWeights(instants_, t);
    value.setZero();
    for (Index k = 0; k < 4; ++k) {
      value += weights[k] * numbers_.col(k);
    }
  } else {
    const Index after = right_ - first;
    const double before = instants_[after - 1];
    const double share = std::clamp((t - before) / (instants_[after] - before), 0.0, 1.0);
    value = (1.0 - share) * numbers_.col(after - 1) + share * numbers_.col(after);
  }
  ++made_;
  if (++waiting_ == values_.cols()) {
    flush();
  }
}

void Resampler::flush() {
  if (waiting_ > 0) {
    take_(values_.leftCols(waiting_));
    waiting_ = 0;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
