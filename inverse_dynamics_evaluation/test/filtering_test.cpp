// SPDX-License-Identifier: Apache-2.0

#include "filtering.hpp"

#include <gmock/gmock.h>

#include <random>

#include "motion.hpp"

namespace inverse_dynamics_evaluation::filtering_test {

using Eigen::Index;

// Relative to the greatest number: rounding errors of a filter with 500 samples per period of its
// cut-off, whose poles lie a hundredth from 1.
constexpr double kRounding = 1e-12;

Eigen::MatrixXd noise(Index joints, Index count) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(3.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(joints, count, [&] { return normal(generator); });
}

double greatest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

// Both ends continued, the filter over the whole, differences of its result.
Eigen::MatrixXd ofTheWhole(const Eigen::MatrixXd& samples, double sampling_frequency, double cutoff,
                           int order) {
  const double period = sampling_frequency / cutoff;
  const Index count = samples.cols();
  const Index fit =
      std::min(std::max<Index>(static_cast<Index>(std::min(1.2 * period, 1.0 * count)), 6), count);
  const Index beyond = std::max<Index>(
      static_cast<Index>(std::min(2.0 * period, 2.0 / 1.2 * count)), 3 * (order + 1));
  const Eigen::MatrixXd backwards = samples.rowwise().reverse();
  Eigen::MatrixXd longer(samples.rows(), count + 2 * beyond);
  longer << beyondEnd(samples.leftCols(fit), beyond).rowwise().reverse(), samples,
      beyondEnd(backwards.leftCols(fit), beyond);
  const Eigen::MatrixXd smooth = lowPass(longer, sampling_frequency, cutoff, order);
  return derivative(smooth, 1.0 / sampling_frequency).middleCols(beyond, count);
}

TEST(DerivativeRoom, GivesInPlaceWhatTheFilterGivesOfTheWhole) {
  for (const Index count : {10, 11, 40, 333, 5000, 60000}) {
    for (const double cutoff : {0.003, 0.1, 0.7, 2.0, 11.0, 49.0}) {
      const Eigen::MatrixXd samples = noise(3, count);
      const DerivativeRoom room(count, 100.0, cutoff, 2);
      Eigen::MatrixXd columns(3, room.size());
      columns.middleCols(room.begin(), count) = samples;
      const Eigen::MatrixXd found = room.differentiate(columns);
      const Eigen::MatrixXd whole = ofTheWhole(samples, 100.0, cutoff, 2);
      // a difference over a period of 0.01 s takes a rounding error a hundredfold
      EXPECT_LT(greatest(found - whole), kRounding * 100.0 * greatest(samples))
          << count << " samples, cut-off " << cutoff << " Hz";
    }
  }
}

}  // namespace inverse_dynamics_evaluation::filtering_test
