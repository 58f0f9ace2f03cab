// SPDX-License-Identifier: Apache-2.0

#include "zero_phase.hpp"

#include <gmock/gmock.h>

#include <random>

#include "ends.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "low_pass_differentiator.hpp"
#include "motion.hpp"

namespace inverse_dynamics_evaluation::zero_phase_test {

using Eigen::Index;

// Relative to the greatest number: rounding errors of a filter with 500 samples per period of its
// cut-off, whose poles lie a hundredth from 1.
constexpr double kRounding = 1e-12;

Eigen::MatrixXd noise(Index joints, Index count) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(3.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(joints, count, [&] { return normal(generator); });
}

// Hands over the columns in pushes of different lengths.
template <class Filter>
void pushAll(const Eigen::MatrixXd& samples, Filter& filter) {
  std::mt19937 generator(8);
  std::uniform_int_distribution<Index> length(1, 700);
  for (Index begin = 0; begin < samples.cols();) {
    const Index count = std::min(length(generator), samples.cols() - begin);
    filter.push(samples.middleCols(begin, count));
    begin += count;
  }
  filter.finish();
}

// Collects columns.
struct Columns {
  explicit Columns(const Eigen::MatrixXd& like) : all(like.rows(), like.cols()) {}
  TakeColumns take() {
    return [this](const auto& next) {
      all.middleCols(count, next.cols()) = next;
      count += next.cols();
    };
  }
  Eigen::MatrixXd all;
  Index count = 0;
};

Eigen::MatrixXd filtered(const Eigen::MatrixXd& samples, double cutoff, int order, Index overlap) {
  Columns columns(samples);
  ZeroPhaseFilter filter(samples.rows(), cutoff, order, overlap, columns.take());
  pushAll(samples, filter);
  EXPECT_EQ(columns.count, samples.cols());
  return columns.all;
}

double greatest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

TEST(ZeroPhaseFilter, GivesByBlocksWhatItGivesOfTheWhole) {
  for (const int order : {1, 2, 3, 4, 7, 12}) {
    for (const double cutoff : {0.45, 0.25, 0.1, 0.01, 0.002}) {
      const Index overlap = ZeroPhaseFilter::overlapOf(cutoff, order);
      const Eigen::MatrixXd samples = noise(2, 3 * overlap + 2000);
      const Eigen::MatrixXd whole = filtered(samples, cutoff, order, ZeroPhaseFilter::kWhole);
      const Eigen::MatrixXd blocks = filtered(samples, cutoff, order, overlap);
      EXPECT_LT(greatest(blocks - whole), kRounding * greatest(whole))
          << "order " << order << ", cut-off " << cutoff << ", overlap " << overlap;
    }
  }
}

TEST(ZeroPhaseFilter, NeedsAnOverlapOfThatOrder) {
  const Eigen::MatrixXd samples = noise(1, 20000);
  const Eigen::MatrixXd whole = filtered(samples, 0.01, 2, ZeroPhaseFilter::kWhole);
  const Index overlap = ZeroPhaseFilter::overlapOf(0.01, 2);
  EXPECT_GT(greatest(filtered(samples, 0.01, 2, overlap / 4) - whole), 1e-9);
  EXPECT_LT(overlap, 20 / 0.01);  // samples: 20 periods of the cut-off
}

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

TEST(LowPassDifferentiator, GivesByPartsWhatTheFilterGivesOfTheWhole) {
  for (const Index count : {10, 11, 40, 333, 5000, 60000}) {
    for (const double cutoff : {0.003, 0.1, 0.7, 2.0, 11.0, 49.0}) {
      const Eigen::MatrixXd samples = noise(3, count);
      Columns columns(samples);
      LowPassDifferentiator differentiator(3, count, 100.0, cutoff, 2, columns.take());
      pushAll(samples, differentiator);
      EXPECT_EQ(columns.count, count);
      const Eigen::MatrixXd whole = ofTheWhole(samples, 100.0, cutoff, 2);
      // a difference over a period of 0.01 s takes a rounding error a hundredfold
      EXPECT_LT(greatest(columns.all - whole), kRounding * 100.0 * greatest(samples))
          << count << " samples, cut-off " << cutoff << " Hz";
    }
  }
}

}  // namespace inverse_dynamics_evaluation::zero_phase_test
