// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/cutoff.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "motion.hpp"
#include "spectrum.hpp"

namespace inverse_dynamics_evaluation::cutoff_test {

// The criterion is an average over noise: what the chosen cut-off may cost in acceleration, against
// the best one found by knowing the truth.
constexpr double kNearBest = 1.35;

CutoffChoice chooseCutoff(const std::vector<Stretch>& stretches, double sampling_frequency) {
  Eigen::Index longest = 0;
  for (const Stretch& stretch : stretches) longest = std::max(longest, stretch.qd.cols());
  SpectrumSums sums(stretches.front().qd.rows(), longest, sampling_frequency);
  for (const Stretch& stretch : stretches) sums.add(stretch);
  const double duration = static_cast<double>(longest - 1) / sampling_frequency;
  return cutoffOf(sums.spectra(), duration, sampling_frequency, 2);
}

double accelerationError(const Motion& motion, double sampling_frequency, double cutoff) {
  return rms(derivative(lowPass(motion.qd, sampling_frequency, cutoff), 1.0 / sampling_frequency),
             motion.qdd);
}

double leastAccelerationError(const Motion& motion, double sampling_frequency) {
  double least = std::numeric_limits<double>::infinity();
  for (double cutoff = 0.3; cutoff < 0.4 * sampling_frequency; cutoff *= 1.1) {
    least = std::min(least, accelerationError(motion, sampling_frequency, cutoff));
  }
  return least;
}

TEST(ChooseCutoff, IsNearTheBestForWhiteNoise) {
  for (const double rate : {30.0, 125.0, 1000.0}) {
    for (const double frequency : {0.2, 1.0, 2.0}) {
      Motion motion = sines(rate, 20.0, {frequency, 0.8 * frequency, 0.6 * frequency});
      addVelocityNoise(motion, 0.005, 1);
      const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, rate);
      EXPECT_LT(accelerationError(motion, rate, choice.cutoff),
                kNearBest * leastAccelerationError(motion, rate))
          << rate << " Hz, motion " << frequency << " Hz, cut-off " << choice.cutoff << " Hz";
    }
  }
}

TEST(ChooseCutoff, IsNearTheBestForColouredNoise) {
  // noise below 40 Hz
  Motion motion = sines(1000.0, 20.0, {1.0, 0.7});
  Motion noise = motion;
  noise.qd.setZero();
  addVelocityNoise(noise, 0.02, 2);
  motion.qd += lowPass(noise.qd, 1000.0, 40.0, 1);
  const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, 1000.0);
  EXPECT_LT(accelerationError(motion, 1000.0, choice.cutoff),
            kNearBest * leastAccelerationError(motion, 1000.0));
}

// Positions in steps of an encoder, with a little noise, and velocities made from them.
void measureByEncoder(Motion& motion, double sampling_frequency, double step, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, 0.3 * step);
  motion.q =
      motion.q.unaryExpr([&](double x) { return step * std::round((x + noise(generator)) / step); })
          .eval();
  motion.qd = derivative(motion.q, 1.0 / sampling_frequency);
}

TEST(ChooseCutoff, SeesTheNoiseThatVelocityTookFromPosition) {
  // q is noisy and qd is its derivative: both say the same, noise and all
  Motion motion = sines(500.0, 20.0, {1.0, 0.7});
  std::mt19937 generator(4);
  std::normal_distribution<double> noise(0.0, 1e-5);
  motion.q = motion.q.unaryExpr([&](double x) { return x + noise(generator); }).eval();
  motion.qd = derivative(motion.q, 1.0 / 500.0);
  const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, 500.0);
  EXPECT_LT(accelerationError(motion, 500.0, choice.cutoff),
            kNearBest * leastAccelerationError(motion, 500.0));
}

TEST(ChooseCutoff, IsNearTheBestWhereAJointSpinsAway) {
  // one joint turns by 2 rad within 0.3 s, in a motion of half a hertz
  Motion motion = sines(125.0, 20.0, {0.5, 0.3});
  const Eigen::ArrayXd x = ((motion.time.array() - 11.0) / 0.3).max(0.0).min(1.0);
  const auto add = [](Eigen::MatrixXd& to, const Eigen::ArrayXd& more) {
    to.row(1) += more.matrix().transpose();
  };
  add(motion.q, 2.0 * x.cube() * (10.0 - 15.0 * x + 6.0 * x.square()));
  add(motion.qd, 2.0 / 0.3 * 30.0 * x.square() * (1.0 - x).square());
  add(motion.qdd, 2.0 / 0.09 * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x));
  addVelocityNoise(motion, 0.001, 18);
  const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, 125.0);
  EXPECT_LT(accelerationError(motion, 125.0, choice.cutoff),
            kNearBest * leastAccelerationError(motion, 125.0))
      << choice.cutoff;
}

TEST(ChooseCutoff, LeavesOutJumpsOfPositions) {
  Motion motion = sines(250.0, 20.0, {1.0, 0.7});
  addVelocityNoise(motion, 0.005, 19);
  const double expected = chooseCutoff({{motion.q, motion.qd}}, 250.0).cutoff;
  motion.q.row(0).tail(2000).array() -= 2.0 * kPi;  // a seam
  motion.q.row(1).tail(1300).array() += 0.5;        // a driver that starts anew
  EXPECT_NEAR(chooseCutoff({{motion.q, motion.qd}}, 250.0).cutoff, expected, 0.1 * expected);
}

TEST(ChooseCutoff, TakesLittleAwayFromExactSamples) {
  const Motion motion = sines(125.0, 20.0, {1.0, 0.7});
  const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, 125.0);
  EXPECT_LT(accelerationError(motion, 125.0, choice.cutoff), 0.01 * rms(motion.qdd, 0 * motion.qdd))
      << choice.cutoff;
}

TEST(ChooseCutoff, DoesNotDependOnUnits) {
  Motion motion = sines(250.0, 10.0, {1.0, 2.0});
  addVelocityNoise(motion, 0.01, 5);
  const CutoffChoice here = chooseCutoff({{motion.q, motion.qd}}, 250.0);
  const CutoffChoice scaled = chooseCutoff({{1000.0 * motion.q, 1000.0 * motion.qd}}, 250.0);
  EXPECT_NEAR(here.cutoff, scaled.cutoff, 1e-9);
}

TEST(ChooseCutoff, ScalesWithTime) {
  // the same samples played twice as fast: velocities and the cut-off double
  Motion motion = sines(250.0, 10.0, {2.0, 3.0});
  addVelocityNoise(motion, 0.01, 5);
  const CutoffChoice slow = chooseCutoff({{motion.q, motion.qd}}, 250.0);
  const CutoffChoice fast = chooseCutoff({{motion.q, 2.0 * motion.qd}}, 500.0);
  // candidates stand in ratios of a few per cent
  EXPECT_NEAR(fast.cutoff / slow.cutoff, 2.0, 0.2);
}

TEST(ChooseCutoff, IgnoresJointsThatNeverMove) {
  Motion motion = sines(250.0, 10.0, {1.0, 2.0});
  addVelocityNoise(motion, 0.01, 5);
  const double expected = chooseCutoff({{motion.q.topRows(1), motion.qd.topRows(1)}}, 250.0).cutoff;
  motion.q.row(1).setConstant(0.3);
  motion.qd.row(1).setZero();
  EXPECT_NEAR(chooseCutoff({{motion.q, motion.qd}}, 250.0).cutoff, expected, 1e-9);
}

TEST(ChooseCutoff, TakesNothingAwayWhereNothingMoves) {
  const Eigen::MatrixXd still = Eigen::MatrixXd::Zero(2, 100);
  const CutoffChoice choice = chooseCutoff({{still, still}}, 100.0);
  EXPECT_EQ(choice.cutoff, choice.highest);
  EXPECT_DOUBLE_EQ(choice.highest, 40.0);
}

TEST(ChooseCutoff, UsesAllStretches) {
  // the noise of the second stretch counts as much as that of the first
  Motion quiet = sines(250.0, 10.0, {1.0});
  Motion noisy = quiet;
  addVelocityNoise(quiet, 1e-4, 6);
  addVelocityNoise(noisy, 3e-2, 7);
  const double alone = chooseCutoff({{quiet.q, quiet.qd}}, 250.0).cutoff;
  const double both = chooseCutoff({{quiet.q, quiet.qd}, {noisy.q, noisy.qd}}, 250.0).cutoff;
  EXPECT_LT(both, 0.8 * alone);
}

TEST(ChooseCutoff, SaysHowMuchOfTheTimeTheArmMoves) {
  Motion motion = restingBut(125.0, 100.0, 40.0, 10.0);
  addVelocityNoise(motion, 0.005, 8);
  // the motion, and half a second and more beside it
  EXPECT_NEAR(chooseCutoff({{motion.q, motion.qd}}, 125.0).moving, 0.11, 0.02);
  motion = sines(125.0, 20.0, {1.0, 0.7});
  addVelocityNoise(motion, 0.005, 8);
  EXPECT_GT(chooseCutoff({{motion.q, motion.qd}}, 125.0).moving, 0.99);
}

TEST(ChooseCutoff, DependsOnTheMotionNotOnTheRestAroundIt) {
  std::vector<double> cutoffs;
  for (const double rest : {2.0, 20.0, 200.0, 600.0}) {
    Motion motion = restingBut(125.0, 2.0 * rest + 2.0, rest, 2.0);
    addVelocityNoise(motion, 0.005, 9);
    cutoffs.push_back(chooseCutoff({{motion.q, motion.qd}}, 125.0).cutoff);
  }
  const auto [least, greatest] = std::minmax_element(cutoffs.begin(), cutoffs.end());
  EXPECT_LT(*greatest, 1.6 * *least);
}

TEST(ChooseCutoff, CountsTheFlipsOfAnEncoderAsRest) {
  // the driver makes velocities from counts, so the noise of both agrees
  Motion motion = restingBut(125.0, 300.0, 150.0, 0.5);
  measureByEncoder(motion, 125.0, 1e-5, 13);
  EXPECT_LT(chooseCutoff({{motion.q, motion.qd}}, 125.0).moving, 0.02);
}

TEST(ChooseCutoff, CountsSlowNoiseOfVelocitiesAsRest) {
  Motion motion = restingBut(250.0, 300.0, 150.0, 0.5);
  Motion noise = motion;
  noise.q.setZero();
  noise.qd.setZero();
  addVelocityNoise(noise, 0.02, 14);
  motion.qd += lowPass(noise.qd, 250.0, 20.0, 1);
  std::mt19937 generator(15);
  std::normal_distribution<double> encoder(0.0, 1e-6);
  motion.q = motion.q.unaryExpr([&](double x) { return x + encoder(generator); }).eval();
  EXPECT_LT(chooseCutoff({{motion.q, motion.qd}}, 250.0).moving, 0.02);
}

TEST(ChooseCutoff, IsNearTheBestForAShortMotionInALongRestWhereVelocityCameFromPosition) {
  constexpr double kRest = 300.0;
  for (const double rate : {125.0, 250.0}) {
    for (const double step : {1e-6, 1e-5, 5e-5}) {
      Motion motion = restingBut(rate, 2.0 * kRest, kRest, 0.5);
      measureByEncoder(motion, rate, step, 16);
      motion.qd = lowPass(motion.qd, rate, 30.0, 1);  // as drivers do
      const double cutoff = chooseCutoff({{motion.q, motion.qd}}, rate).cutoff;
      // the motion and 5 s to either side
      const auto begin = static_cast<Eigen::Index>((kRest - 5.0) * rate);
      const auto count = static_cast<Eigen::Index>(10.5 * rate);
      const auto moving = static_cast<Eigen::Index>(0.5 * rate);
      const auto error = [&](double tried) -> double {
        const Eigen::MatrixXd qdd =
            derivative(lowPass(motion.qd.middleCols(begin, count), rate, tried), 1.0 / rate);
        return rms(qdd.middleCols((count - moving) / 2, moving),
                   motion.qdd.middleCols(begin + (count - moving) / 2, moving));
      };
      double least = std::numeric_limits<double>::infinity();
      for (double tried = 0.3; tried < 0.4 * rate; tried *= 1.1) {
        least = std::min(least, error(tried));
      }
      EXPECT_LT(error(cutoff), kNearBest * least)
          << rate << " Hz, steps of " << step << ", cut-off " << cutoff << " Hz";
    }
  }
}

TEST(ChooseCutoff, UsesStretchesOfAnyLength) {
  // the only motion is in a stretch shorter than a segment
  Motion rest = restingBut(125.0, 60.0, 100.0, 1.0);
  Motion motion = restingBut(125.0, 4.0, 1.0, 2.0);
  addVelocityNoise(rest, 0.005, 10);
  addVelocityNoise(motion, 0.005, 11);
  const double alone = chooseCutoff({{motion.q, motion.qd}}, 125.0).cutoff;
  const double both = chooseCutoff({{rest.q, rest.qd}, {motion.q, motion.qd}}, 125.0).cutoff;
  EXPECT_LT(std::abs(std::log(both / alone)), std::log(1.3)) << both << " " << alone;
}

TEST(ChooseCutoff, CountsNoStretchesThatAreTooShortToBeUsed) {
  Motion motion = sines(125.0, 10.0, {1.0, 0.7});
  addVelocityNoise(motion, 0.005, 12);
  std::vector<Stretch> stretches = {{motion.q, motion.qd}};
  for (int i = 0; i < 200; ++i) {
    stretches.push_back({motion.q.leftCols(12), motion.qd.leftCols(12)});
  }
  EXPECT_GT(chooseCutoff(stretches, 125.0).moving, 0.99);
}

TEST(ChooseCutoff, TakesSamplesThatAreFarApart) {
  // a segment of 20 s would have less than one sample
  Motion motion = sines(0.04, 5000.0, {0.001});
  addVelocityNoise(motion, 0.005, 17);
  const CutoffChoice choice = chooseCutoff({{motion.q, motion.qd}}, 0.04);
  EXPECT_GT(choice.cutoff, 0.0);
  EXPECT_LE(choice.cutoff, choice.highest);
  EXPECT_LT(accelerationError(motion, 0.04, choice.cutoff),
            2.0 * accelerationError(motion, 0.04, 0.4 * 0.04));
}

}  // namespace inverse_dynamics_evaluation::cutoff_test
