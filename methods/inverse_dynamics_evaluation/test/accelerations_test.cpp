// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "error_of.hpp"
#include "filtering.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "joint_log.hpp"
#include "motion.hpp"

namespace inverse_dynamics_evaluation::accelerations_test {

using ::testing::HasSubstr;

// Derivative of equidistant samples [1/s] after the zero-phase low-pass.
Eigen::MatrixXd lowPassDerivative(const Eigen::MatrixXd& samples, double rate, double cutoff,
                                  int order = 2) {
  const DerivativeRoom room(samples.cols(), rate, cutoff, order);
  Eigen::MatrixXd columns(samples.rows(), room.size());
  columns.middleCols(room.begin(), samples.cols()) = samples;
  return room.differentiate(columns);
}

LogAccelerations estimate(const Motion& motion, const LowPassOptions& options = {}) {
  return accelerationsOf(*tableOf(motion.time, motion.q, motion.qd, motion.effort),
                         AccelerationMethod::kLowPass, options);
}

// Columns of a motion from one instant to another, both within it.
Motion cut(const Motion& motion, double begin, double end) {
  const double period = motion.time[1] - motion.time[0];
  std::vector<Eigen::Index> samples;
  for (auto k = static_cast<Eigen::Index>(std::lround(begin / period));
       k <= std::lround(end / period); ++k) {
    samples.push_back(k);
  }
  const auto count = static_cast<Eigen::Index>(samples.size());
  return pick(motion, samples, motion.time.head(count));
}

// The least error of accelerations by lowPass() and derivative(), its ends continued by reflection,
// over all cut-offs: what a user could reach who knows the truth. From column `first`, `count`.
double bestFixedError(const Motion& motion, Eigen::Index first, Eigen::Index count) {
  const double rate = 1.0 / (motion.time[1] - motion.time[0]);
  double least = std::numeric_limits<double>::infinity();
  for (double cutoff = 0.25; cutoff < std::min(80.0, 0.4 * rate); cutoff *= 1.1) {
    const Eigen::MatrixXd qdd = derivative(lowPass(motion.qd, rate, cutoff), 1.0 / rate);
    least = std::min(least, rms(qdd.middleCols(first, count), motion.qdd.middleCols(first, count)));
  }
  return least;
}

double bestFixedError(const Motion& motion) { return bestFixedError(motion, 0, motion.count()); }

LowPassOptions cutoffOf(double cutoff) {
  LowPassOptions options;
  options.cutoff = cutoff;
  return options;
}

// The motion of which those samples were lost.
template <class Lost>
Motion without(const Motion& motion, Lost lost) {
  std::vector<Eigen::Index> samples;
  std::vector<double> time;
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    if (lost(k)) continue;
    samples.push_back(k);
    time.push_back(motion.time[k]);
  }
  return pick(motion, samples,
              Eigen::Map<Eigen::VectorXd>(time.data(), static_cast<Eigen::Index>(time.size())));
}

TEST(BackwardDifference, IsTheOneWorkedByHand) {
  Eigen::VectorXd time(5);
  time << 0.0, 0.5, 0.5, 0.25, 1.25;  // an equal stamp, a backward one
  Eigen::MatrixXd qd(2, 5);
  qd << 0, 1, 3, 3, 1,  //
      2, 2, 2, 4, 4;
  Eigen::MatrixXd expected(2, 5);
  expected << 0, 2, 0, 0, -2,  //
      0, 0, 0, 0, 0;
  EXPECT_EQ(backwardDifference(time, qd), expected);
}

TEST(BackwardDifference, IsExactOnARampButForTheFirstSample) {
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(9, 0.0, 2.0);
  const Eigen::MatrixXd qdd = backwardDifference(time, 3.0 * time.transpose());
  EXPECT_EQ(qdd(0, 0), 0.0);
  EXPECT_LT((qdd.rightCols(8).array() - 3.0).abs().maxCoeff(), 1e-14);
}

TEST(BackwardDifference, RefusesBadInput) {
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(4, 0.0, 1.0);
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { backwardDifference(time, Eigen::MatrixXd::Ones(2, 3)); }),
      HasSubstr("backward difference: time: expected 3 stamps, one per column of the samples, got "
                "4; a sample is a column"));
  EXPECT_THROW(backwardDifference(Eigen::VectorXd(), Eigen::MatrixXd(2, 0)), std::invalid_argument);
  Eigen::MatrixXd bad = Eigen::MatrixXd::Ones(2, 4);
  bad(0, 2) = -std::numeric_limits<double>::infinity();
  EXPECT_THAT(errorOf<EvaluationError>([&] { backwardDifference(time, bad); }),
              HasSubstr("got -inf for joint 1 in sample 3"));
}

TEST(LowPassDerivative, IsThatOfTheLowPassAwayFromTheEnds) {
  Motion motion = sines(200.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const Eigen::MatrixXd plain = derivative(lowPass(motion.qd, 200.0, 4.0), 1.0 / 200.0);
  const Eigen::MatrixXd result = lowPassDerivative(motion.qd, 200.0, 4.0);
  // 5 periods of the cut-off from the ends the filter has forgotten them: exp(-pi sqrt(2) 5)
  constexpr Eigen::Index kMargin = 250;
  const Eigen::Index inner = motion.count() - 2 * kMargin;
  EXPECT_LT((result - plain).middleCols(kMargin, inner).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_EQ(result.cols(), motion.count());
}

TEST(LowPassDerivative, IsExactForParabolasEndsIncluded) {
  // all that is left is the start of the filter, two periods of the cut-off beyond the ends
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(501, 0.0, 5.0);
  const Eigen::MatrixXd x = (3.0 + 2.0 * t - 0.5 * t.square()).matrix().transpose();
  const Eigen::MatrixXd expected = (2.0 - t).matrix().transpose();
  EXPECT_LT((lowPassDerivative(x, 100.0, 2.0) - expected).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(LowPassDerivative, WorksOnFewSamplesAndSlowCutOffs) {
  const Eigen::RowVectorXd ramp = Eigen::RowVectorXd::LinSpaced(10, 0.0, 9.0);
  EXPECT_TRUE(lowPassDerivative(ramp, 10.0, 1e-3).allFinite());
  for (const double cutoff : {1.0, 4.9}) {
    EXPECT_LT((lowPassDerivative(ramp, 10.0, cutoff).array() - 10.0).abs().maxCoeff(), 0.5)
        << cutoff;
  }
}

TEST(LowPassAccelerations, AreThoseOfTheMotion) {
  for (const double rate : {30.0, 125.0, 1000.0}) {
    const Motion motion = sines(rate, 10.0, {0.5, 1.0});
    const LogAccelerations result = estimate(motion, cutoffOf(0.4 * rate));
    // away from the ends: 1 Hz through 12 Hz at 30 Hz sampling loses 5e-5, central differences 2e-3
    const auto margin = static_cast<Eigen::Index>(rate);
    const Eigen::Index inner = motion.count() - 2 * margin;
    EXPECT_LT(rms(result.qdd.middleCols(margin, inner), motion.qdd.middleCols(margin, inner)),
              1e-3 * rms(motion.qdd, 0 * motion.qdd))
        << rate << " Hz";
  }
}

TEST(LowPassAccelerations, AreFarBetterThanDifferencesOfNoisyVelocities) {
  Motion motion = sines(1000.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const double raw = rms(backwardDifference(motion.time, motion.qd), motion.qdd);
  const double filtered = rms(estimate(motion).qdd, motion.qdd);
  EXPECT_NEAR(raw, 0.005 * std::sqrt(2.0) * 1000.0, 0.1);  // as the header says
  EXPECT_LT(filtered, 0.02 * raw);
}

// The best fixed cut-off knows the truth; the default may be off by a tenth.
constexpr double kNearBest = 1.1;

TEST(LowPassAccelerations, AreNearTheBestFixedCutOffEndsIncluded) {
  // cut out of a motion: velocity, acceleration and jerk at both ends
  double sum = 0.0;
  int cases = 0;
  for (const double rate : {125.0, 1000.0}) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      Motion motion = cut(sines(rate, 25.0, {0.8, 1.1, 1.5}), 1.3 * seed, 15.0 + 1.7 * seed);
      addVelocityNoise(motion, 0.005, seed);
      const double ratio = rms(estimate(motion).qdd, motion.qdd) / bestFixedError(motion);
      EXPECT_LT(ratio, kNearBest) << rate << " Hz, seed " << seed;
      sum += ratio;
      ++cases;
    }
  }
  // that best one still suffers from the reflection at the ends: the default is better than it
  EXPECT_LT(sum / cases, 1.0);
}

TEST(LowPassAccelerations, AreNearTheBestFixedCutOffWhereVelocitiesAreDifferencesOfCounts) {
  // an encoder of 1e-3 rad, and velocities made from it: all frequencies up to 500 Hz agree
  Motion motion = sines(1000.0, 20.0, {0.5, 0.35});
  std::mt19937 generator(18);
  std::normal_distribution<double> noise(0.0, 3e-4);
  motion.q =
      motion.q.unaryExpr([&](double x) { return 1e-3 * std::round((x + noise(generator)) / 1e-3); })
          .eval();
  motion.qd = derivative(motion.q, 1e-3);
  EXPECT_LT(rms(estimate(motion).qdd, motion.qdd), kNearBest * bestFixedError(motion));
}

TEST(LowPassAccelerations, AreAsGoodAtTheEndsAsInBetweenWithHardlyAnyNoise) {
  for (const double rate : {125.0, 1000.0}) {
    Motion motion = cut(sines(rate, 25.0, {0.4, 0.2, 0.3}), 2.0, 22.0);
    addVelocityNoise(motion, 1e-6, 1);
    const Eigen::MatrixXd qdd = estimate(motion).qdd;
    const auto margin = static_cast<Eigen::Index>(0.5 * rate);
    const Eigen::Index inner = motion.count() - 2 * margin;
    EXPECT_LT(rms(qdd, motion.qdd),
              2.0 * rms(qdd.middleCols(margin, inner), motion.qdd.middleCols(margin, inner)))
        << rate << " Hz";
  }
}

TEST(LowPassAccelerations, OfThreeSecondsAreNearTheBestFixedCutOff) {
  for (const double rate : {125.0, 1000.0}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      for (const double begin : {0.2, 0.7}) {
        Motion motion = restingBut(rate, 3.0, begin, 2.0);
        addVelocityNoise(motion, 0.005, seed);
        EXPECT_LT(rms(estimate(motion).qdd, motion.qdd), kNearBest * bestFixedError(motion))
            << rate << " Hz, from " << begin << " s, seed " << seed;
      }
    }
  }
}

// Error within one motion of half a second in 20 minutes of rest, over that of the best fixed
// cut-off there.
double ratioWithinMotion(double begin, std::uint32_t seed) {
  Motion motion = restingBut(125.0, 1200.0, begin, 0.5);
  addVelocityNoise(motion, 0.005, seed);
  const Eigen::MatrixXd qdd = estimate(motion).qdd;
  const auto first = static_cast<Eigen::Index>(begin * 125.0);
  constexpr Eigen::Index kCount = 63;
  // ten seconds to either side are all that a fixed cut-off sees
  const Eigen::Index from = std::max<Eigen::Index>(first - 1250, 0);
  const Eigen::Index to = std::min(first + kCount + 1250, motion.count() - 1);
  const Motion around = cut(motion, motion.time[from], motion.time[to]);
  return rms(qdd.middleCols(first, kCount), motion.qdd.middleCols(first, kCount)) /
         bestFixedError(around, first - from, kCount);
}

TEST(LowPassAccelerations, FollowAShortMotionInALongRest) {
  EXPECT_LT(ratioWithinMotion(600.3, 1), 1.5);
  EXPECT_LT(ratioWithinMotion(0.5, 2), 1.5);
  EXPECT_LT(ratioWithinMotion(1198.9, 3), 1.5);
  EXPECT_LT(ratioWithinMotion(333.3, 4), 1.5);
}

TEST(LowPassAccelerations, SayWhatTheyDid) {
  Motion motion = sines(200.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const LogAccelerations chosen = estimate(motion);
  EXPECT_TRUE(chosen.filter.chosen);
  EXPECT_EQ(chosen.filter.cutoff, chosen.filter.choice.cutoff);
  EXPECT_EQ(chosen.filter.order, 2);
  EXPECT_NEAR(chosen.filter.sampling_frequency, 200.0, 1e-6);
  EXPECT_EQ(chosen.filter.time_base, TimeBase::kStamps);
  EXPECT_EQ(chosen.filter.pieces, 1);
  EXPECT_THAT(chosen.filter.method, HasSubstr("zero-phase Butterworth"));

  // what was said is what was done
  const LogAccelerations given = estimate(motion, cutoffOf(chosen.filter.cutoff));
  EXPECT_FALSE(given.filter.chosen);
  EXPECT_EQ(given.qdd, chosen.qdd);
  const Eigen::MatrixXd by_hand =
      lowPassDerivative(motion.qd, 200.0, chosen.filter.cutoff, chosen.filter.order);
  EXPECT_LT(rms(chosen.qdd, by_hand), 1e-9);
}

TEST(LowPassAccelerations, DoNotSufferFromRepeatsAndJitteringStamps) {
  Motion clean = sines(1000.0, 10.0, {0.5, 1.0});
  addVelocityNoise(clean, 0.005, 1);
  Motion motion = withRepeats(clean, 8);
  jitterStamps(motion, 0.8, 2);
  const LogAccelerations result = estimate(motion);
  EXPECT_LT(rms(result.qdd, motion.qdd), 1.2 * rms(estimate(clean).qdd, clean.qdd));
  EXPECT_EQ(result.samples.counts.repeated, motion.count() / 8);
  // a repeat gets the acceleration of the sample it repeats
  EXPECT_EQ(result.qdd.col(7), result.qdd.col(6));
}

TEST(LowPassAccelerations, DoNotSufferFromLostSamplesOfFastMotion) {
  // 5 Hz at 125 Hz: a straight line over a lost sample would miss 6 % of the velocity
  Motion clean = sines(125.0, 10.0, {5.0, 4.0});
  addVelocityNoise(clean, 3e-4, 1);
  const Motion motion = without(clean, [](Eigen::Index k) { return k % 10 == 5; });
  EXPECT_LT(rms(estimate(motion).qdd, motion.qdd), 1.2 * rms(estimate(clean).qdd, clean.qdd));
}

TEST(LowPassAccelerations, DoNotEnlargeNoiseAcrossHoles) {
  // 60 samples lost in a row: a cubic's slopes would be those of two noisy samples
  Motion clean = sines(1000.0, 20.0, {0.5, 1.0});
  addVelocityNoise(clean, 5e-3, 1);
  const Motion motion = without(clean, [](Eigen::Index k) { return k % 1500 >= 1440; });
  EXPECT_LT(rms(estimate(motion, cutoffOf(8.0)).qdd, motion.qdd),
            3.0 * rms(estimate(clean, cutoffOf(8.0)).qdd, clean.qdd));
}

TEST(LowPassAccelerations, HaveTheSameCutOffWithAndWithoutShortGaps) {
  // straight lines over these gaps would have corners that halve the cut-off
  Motion clean = sines(125.0, 30.0, {0.5, 1.0});
  addVelocityNoise(clean, 1e-3, 1);
  const LogAccelerations whole = estimate(clean);
  for (const Eigen::Index lost : {1, 3, 10}) {
    const Motion motion = without(clean, [&](Eigen::Index k) { return k % 400 >= 400 - lost; });
    const LogAccelerations result = estimate(motion);
    EXPECT_EQ(result.filter.pieces, 1);
    EXPECT_NEAR(result.filter.cutoff, whole.filter.cutoff, 0.1 * whole.filter.cutoff) << lost;
    EXPECT_LT(rms(result.qdd, motion.qdd), 1.2 * rms(whole.qdd, clean.qdd)) << lost;
  }
}

TEST(LowPassAccelerations, DoNotMultiplySamplesThatComeInBursts) {
  // two publishers, a tenth of a microsecond apart: a grid so fine would have 1.6e9 samples
  const Motion once = sines(125.0, 20.0, {0.5, 1.0});
  std::vector<Eigen::Index> samples;
  Eigen::VectorXd time(2 * once.count());
  for (Eigen::Index k = 0; k < once.count(); ++k) {
    samples.insert(samples.end(), {k, k});
    time[2 * k] = once.time[k];
    time[2 * k + 1] = once.time[k] + 1e-7;
  }
  Motion twice = pick(once, samples, time);
  addVelocityNoise(twice, 1e-4, 1);  // so that no sample repeats the one before
  LowPassOptions options = cutoffOf(8.0);
  options.rules.time_base = false;
  const LogAccelerations result = estimate(twice, options);
  EXPECT_LT(result.filter.sampling_frequency, 5.0 * 125.0);
  EXPECT_LT(rms(result.qdd, twice.qdd), 0.1);
}

TEST(LowPassAccelerations, FilterPiecesBetweenGapsByThemselves) {
  Motion motion = sines(200.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.002, 1);
  motion.time.tail(motion.count() - 800).array() += 100.0;
  const LogAccelerations result = estimate(motion, cutoffOf(8.0));
  EXPECT_EQ(result.filter.pieces, 2);
  const Eigen::MatrixXd first = lowPassDerivative(motion.qd.leftCols(800), 200.0, 8.0);
  const Eigen::MatrixXd second =
      lowPassDerivative(motion.qd.rightCols(motion.count() - 800), 200.0, 8.0);
  EXPECT_LT(rms(result.qdd.leftCols(800), first), 1e-6);
  EXPECT_LT(rms(result.qdd.rightCols(motion.count() - 800), second), 1e-6);
}

TEST(LowPassAccelerations, GiveEverySampleANumber) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  motion.time.tail(motion.count() - 400).array() += 3.0;
  motion.time.tail(motion.count() - 405).array() += 2.0;  // five samples alone
  motion.time[700] = motion.time[690];
  const LogAccelerations result = estimate(motion, cutoffOf(5.0));
  EXPECT_TRUE(result.qdd.allFinite());
  EXPECT_EQ(result.samples.counts.kept, motion.count() - 6);
  // those alone lie on the line between their neighbours
  const Eigen::VectorXd low = result.qdd.col(399).cwiseMin(result.qdd.col(405));
  const Eigen::VectorXd high = result.qdd.col(399).cwiseMax(result.qdd.col(405));
  for (Eigen::Index k = 400; k < 405; ++k) {
    EXPECT_TRUE((result.qdd.col(k).array() >= low.array() - 1e-12).all()) << k;
    EXPECT_TRUE((result.qdd.col(k).array() <= high.array() + 1e-12).all()) << k;
  }
}

TEST(LowPassAccelerations, WorkWithoutEfforts) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const Eigen::MatrixXd with = estimate(motion).qdd;
  motion.effort.resize(0, 0);
  EXPECT_EQ(estimate(motion).qdd, with);
}

TEST(LowPassAccelerations, RefuseWhatTheyCannotFilter) {
  const Motion motion = sines(100.0, 1.0, {0.5, 1.0});
  EXPECT_THAT(errorOf<EvaluationError>([&] { estimate(motion, cutoffOf(60.0)); }),
              HasSubstr("cut-off: expected above 0 and below half the sampling frequency, 50 Hz, "
                        "got 60 Hz"));
  EXPECT_THROW(estimate(motion, cutoffOf(-1.0)), EvaluationError);
  Motion few = pick(motion, {0, 1, 2, 3, 4, 5, 6, 7, 8}, motion.time.head(9));
  EXPECT_THAT(errorOf<EvaluationError>([&] { estimate(few); }),
              HasSubstr("samples: expected 10 or more that differ, without a gap, got 9"));
  few = pick(motion, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, motion.time.head(12));
  EXPECT_THAT(errorOf<EvaluationError>([&] { estimate(few); }),
              HasSubstr("expected 16 or more without a gap, got 12"));
  EXPECT_TRUE(estimate(few, cutoffOf(10.0)).qdd.allFinite());  // enough where it is given
}

}  // namespace inverse_dynamics_evaluation::accelerations_test
