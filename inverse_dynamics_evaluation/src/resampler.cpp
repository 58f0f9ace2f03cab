// SPDX-License-Identifier: Apache-2.0

#include "resampler.hpp"

#include <algorithm>
#include <cmath>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// Distances of samples that a cubic may run through, in periods: across a longer hole, the noise of
// the two samples at either end would set its slope.
constexpr double kLeastApart = 0.5;
constexpr double kMostApart = 3.0;

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

// Weights on the straight line between the two samples around t.
Eigen::Vector4d linearWeights(const Eigen::Vector4d& at, double t) {
  Index after = 1;
  while (after < 3 && at[after] < t) ++after;
  const double share = std::clamp((t - at[after - 1]) / (at[after] - at[after - 1]), 0.0, 1.0);
  Eigen::Vector4d weights = Eigen::Vector4d::Zero();
  weights[after - 1] = 1.0 - share;
  weights[after] = share;
  return weights;
}

}  // namespace

Grid::Grid(const Piece& piece, double usual_period) : Piece(piece) {
  const double duration = end - begin;
  count = std::max(static_cast<Index>(std::llround(duration / usual_period)) + 1, used);
  period = duration / static_cast<double>(count - 1);
}

Resampler::Resampler(const SampleTable& table, const Grid& grid)
    : table_(table), grid_(grid), ahead_(grid.first) {
  for (int i = 0; i < 4; ++i) advance();
}

// Takes one sample further; false at the end of the piece.
bool Resampler::advance() {
  while (ahead_ < grid_.behind && !table_.used[ahead_]) ++ahead_;
  if (ahead_ == grid_.behind) return false;
  std::rotate(samples_.begin(), samples_.begin() + 1, samples_.end());
  instants_.head<3>() = instants_.tail<3>().eval();
  samples_[3] = ahead_;
  instants_[3] = table_.instant[ahead_++];
  return true;
}

void Resampler::next() {
  const double t = grid_.begin + static_cast<double>(made_++) * grid_.period;
  // the instant lies between the middle two where there are samples beyond
  while (t > instants_[2] && advance()) {
  }
  const Eigen::Vector3d apart = (instants_.tail<3>() - instants_.head<3>()) / grid_.period;
  weights_ = apart.minCoeff() >= kLeastApart && apart.maxCoeff() <= kMostApart
                 ? cubicWeights(instants_, t)
                 : linearWeights(instants_, t);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
