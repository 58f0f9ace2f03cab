// SPDX-License-Identifier: Apache-2.0

#include "activity.hpp"

#include <algorithm>
#include <cmath>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr double kBlockSeconds = 0.1;
constexpr Index kAverage = 2;  // blocks to either side that are averaged
constexpr Index kMargin = 5;   // blocks to either side of a motion that count as motion
constexpr double kNoiseShare =
    0.1;  // of the variance of qd's noise: motion power above it is motion
constexpr double kStepShare = 8.0;  // of the square of q's largest step, over a block squared
constexpr double kSecondDifference = 6.0;  // variance of a second difference of white noise

// Squared second differences about the samples from `first` to `last` - 1.
struct SecondDifferences {
  Eigen::ArrayXd mean, greatest;
};

SecondDifferences secondDifferences(const Eigen::Ref<const Eigen::MatrixXd>& x, Index first,
                                    Index last) {
  SecondDifferences squares{Eigen::ArrayXd::Zero(x.rows()), Eigen::ArrayXd::Zero(x.rows())};
  for (Index k = first; k < last; ++k) {
    const Eigen::ArrayXd square = (x.col(k + 1) - 2.0 * x.col(k) + x.col(k - 1)).array().square();
    squares.mean += square / static_cast<double>(last - first);
    squares.greatest = squares.greatest.max(square);
  }
  return squares;
}

// Motion power of all joints in each block of samples, and what noise may pretend; n x B.
struct BlockPowers {
  Eigen::ArrayXXd motion;
  Eigen::ArrayXXd noise;
};

BlockPowers blockPowers(const Stretch& stretch, double sampling_frequency, Index length) {
  const Index samples = stretch.qd.cols();
  const Index blocks = std::max<Index>((samples - 1) / length, 1);
  BlockPowers powers{Eigen::ArrayXXd::Zero(stretch.qd.rows(), blocks),
                     Eigen::ArrayXXd::Zero(stretch.qd.rows(), blocks)};
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = b * length;
    const Index count = std::min(length, samples - 1 - begin);
    const Eigen::ArrayXd velocity = stretch.qd.middleCols(begin, count + 1).rowwise().mean();
    const Eigen::ArrayXd rate = (stretch.q.col(begin + count) - stretch.q.col(begin)) *
                                (sampling_frequency / static_cast<double>(count));
    powers.motion.col(b) = (velocity * rate).min(rate.square());
    const Index first = std::max<Index>(begin, 1);
    const Index last = std::max(first + 1, begin + count);
    const double seconds = static_cast<double>(count) / sampling_frequency;
    powers.noise.col(b) =
        kNoiseShare / kSecondDifference * secondDifferences(stretch.qd, first, last).mean +
        kStepShare / (seconds * seconds) * secondDifferences(stretch.q, first, last).greatest;
  }
  return powers;
}

// Means over `half` neighbours to either side, as far as there are any.
Eigen::ArrayXd averaged(const Eigen::ArrayXXd& values, Index at, Index half) {
  const Index begin = std::max<Index>(at - half, 0);
  const Index end = std::min(at + half + 1, values.cols());
  return values.middleCols(begin, end - begin).rowwise().mean();
}

// Whether the arm moves in each block: 0 to 1.
Eigen::ArrayXd movingBlocks(const BlockPowers& powers) {
  Eigen::ArrayXd moving(powers.motion.cols());
  for (Index b = 0; b < moving.size(); ++b) {
    const Eigen::ArrayXd motion = averaged(powers.motion, b, kAverage).max(0.0);
    const Eigen::ArrayXd noise = averaged(powers.noise, b, kAverage);
    // of the joint that moves most clearly; exact samples of a motion have no noise
    const Eigen::ArrayXd sum = motion.square() + noise.square();
    moving[b] = (sum > 0).select(motion.square() / sum, 0.0).maxCoeff();
  }
  return moving;
}

}  // namespace

Eigen::ArrayXd activity(const Stretch& stretch, double sampling_frequency) {
  const Index samples = stretch.qd.cols();
  const Index length = std::max<Index>(std::llround(kBlockSeconds * sampling_frequency), 1);
  const Eigen::ArrayXd moving = movingBlocks(blockPowers(stretch, sampling_frequency, length));

  // the margin beside a motion, rising and falling smoothly
  const Index blocks = moving.size();
  Eigen::ArrayXd widened(blocks);
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = std::max<Index>(b - 2 * kMargin, 0);
    const Index end = std::min(b + 2 * kMargin + 1, blocks);
    widened[b] = 0.0;
    for (Index i = begin; i < end; ++i) {
      const double beyond = std::max<double>(0.0, static_cast<double>(std::abs(i - b) - kMargin));
      const double fall =
          std::cos(std::acos(-1.0) / 2.0 * beyond / static_cast<double>(kMargin + 1));
      widened[b] = std::max(widened[b], fall * fall * moving[i]);
    }
  }

  // on straight lines between the middles of the blocks
  Eigen::ArrayXd weight(samples);
  for (Index k = 0; k < samples; ++k) {
    const double at = std::clamp((static_cast<double>(k) + 0.5) / static_cast<double>(length) - 0.5,
                                 0.0, static_cast<double>(blocks - 1));
    const auto before = std::min(static_cast<Index>(at), blocks - 1);
    const Index after = std::min(before + 1, blocks - 1);
    const double share = at - static_cast<double>(before);
    weight[k] = (1.0 - share) * widened[before] + share * widened[after];
  }
  return weight;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
