// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "motion.hpp"

namespace inverse_dynamics_evaluation {
namespace {

using ::testing::HasSubstr;

AccelerationEstimate estimate(const Motion& motion, const LowPassOptions& options = {}) {
  return lowPassAccelerations(motion.time, motion.q, motion.qd, motion.effort, options);
}

LowPassOptions cutoffOf(double cutoff) {
  LowPassOptions options;
  options.cutoff = cutoff;
  return options;
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
              HasSubstr("got -inf for joint 0 in sample 2"));
}

TEST(Derivative, IsExactForPolynomialsOfFourthOrder) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(21, -1.0, 1.0);
  const Eigen::MatrixXd x = (t.pow(4) - 2.0 * t.pow(3) + t).matrix().transpose();
  const Eigen::MatrixXd expected = (4.0 * t.pow(3) - 6.0 * t.square() + 1.0).matrix().transpose();
  const Eigen::MatrixXd result = derivative(x, 0.1);
  EXPECT_LT((result - expected).middleCols(2, 17).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Derivative, IsExactForParabolasBesideTheEndsAndForRampsAtThem) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(6, 0.0, 5.0);
  const Eigen::MatrixXd parabola = derivative(t.square().matrix().transpose(), 1.0);
  EXPECT_NEAR(parabola(0, 1), 2.0, 1e-13);
  EXPECT_NEAR(parabola(0, 4), 8.0, 1e-13);
  const Eigen::MatrixXd ramp = derivative((3.0 * t).matrix().transpose(), 1.0);
  EXPECT_LT((ramp.array() - 3.0).abs().maxCoeff(), 1e-13);
  EXPECT_EQ(derivative(Eigen::RowVector2d(1.0, 5.0), 2.0), Eigen::RowVector2d(2.0, 2.0));
}

TEST(Derivative, RefusesBadInput) {
  EXPECT_THROW(derivative(Eigen::MatrixXd::Ones(2, 1), 1.0), EvaluationError);
  EXPECT_THAT(errorOf<EvaluationError>([] { derivative(Eigen::MatrixXd::Ones(2, 9), 0.0); }),
              HasSubstr("period: expected a positive number"));
}

TEST(LowPassAccelerations, AreThoseOfTheMotion) {
  for (const double rate : {30.0, 125.0, 1000.0}) {
    const Motion motion = sines(rate, 10.0, {0.5, 1.0});
    const AccelerationEstimate result = estimate(motion, cutoffOf(0.4 * rate));
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

TEST(LowPassAccelerations, HaveNoDelay) {
  Motion motion = sines(500.0, 10.0, {1.0});
  addVelocityNoise(motion, 0.002, 1);
  const Eigen::MatrixXd qdd = estimate(motion).qdd;
  // the shift at which estimate and truth correlate best
  double best = -1.0;
  Eigen::Index best_shift = 99;
  for (Eigen::Index shift = -20; shift <= 20; ++shift) {
    const double correlation =
        qdd.row(0).segment(500 + shift, 4000).dot(motion.qdd.row(0).segment(500, 4000));
    if (correlation > best) {
      best = correlation;
      best_shift = shift;
    }
  }
  EXPECT_EQ(best_shift, 0);
}

TEST(LowPassAccelerations, SayWhatTheyDid) {
  Motion motion = sines(200.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const AccelerationEstimate chosen = estimate(motion);
  EXPECT_TRUE(chosen.filter.chosen);
  EXPECT_EQ(chosen.filter.cutoff, chosen.filter.choice.cutoff);
  EXPECT_EQ(chosen.filter.order, 2);
  EXPECT_NEAR(chosen.filter.sampling_frequency, 200.0, 1e-6);
  EXPECT_EQ(chosen.filter.time_base, TimeBase::kStamps);
  EXPECT_EQ(chosen.filter.pieces, 1);
  EXPECT_THAT(chosen.filter.method, HasSubstr("zero-phase Butterworth"));

  // what was said is what was done
  const AccelerationEstimate given = estimate(motion, cutoffOf(chosen.filter.cutoff));
  EXPECT_FALSE(given.filter.chosen);
  EXPECT_EQ(given.qdd, chosen.qdd);
  const Eigen::MatrixXd by_hand =
      derivative(lowPass(motion.qd, 200.0, chosen.filter.cutoff, chosen.filter.order), 1.0 / 200.0);
  EXPECT_LT(rms(chosen.qdd, by_hand), 1e-9);
}

TEST(LowPassAccelerations, DoNotSufferFromRepeatsAndJitteringStamps) {
  Motion clean = sines(1000.0, 10.0, {0.5, 1.0});
  addVelocityNoise(clean, 0.005, 1);
  Motion motion = withRepeats(clean, 8);
  jitterStamps(motion, 0.8, 2);
  const AccelerationEstimate result = estimate(motion);
  EXPECT_LT(rms(result.qdd, motion.qdd), 1.2 * rms(estimate(clean).qdd, clean.qdd));
  EXPECT_EQ(result.samples.repeated.count(), motion.count() / 8);
  // a repeat gets the acceleration of the sample it repeats
  EXPECT_EQ(result.qdd.col(7), result.qdd.col(6));
}

TEST(LowPassAccelerations, FilterPiecesBetweenGapsByThemselves) {
  Motion motion = sines(200.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.002, 1);
  motion.time.tail(motion.count() - 800).array() += 100.0;
  const AccelerationEstimate result = estimate(motion, cutoffOf(8.0));
  EXPECT_EQ(result.filter.pieces, 2);
  const Eigen::MatrixXd first = derivative(lowPass(motion.qd.leftCols(800), 200.0, 8.0), 0.005);
  const Eigen::MatrixXd second =
      derivative(lowPass(motion.qd.rightCols(motion.count() - 800), 200.0, 8.0), 0.005);
  EXPECT_LT(rms(result.qdd.leftCols(800), first), 1e-6);
  EXPECT_LT(rms(result.qdd.rightCols(motion.count() - 800), second), 1e-6);
}

TEST(LowPassAccelerations, GiveEverySampleANumber) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  motion.time.tail(motion.count() - 400).array() += 3.0;
  motion.time.tail(motion.count() - 405).array() += 2.0;  // five samples alone
  motion.time[700] = motion.time[690];
  const AccelerationEstimate result = estimate(motion, cutoffOf(5.0));
  EXPECT_TRUE(result.qdd.allFinite());
  EXPECT_EQ(result.samples.kept.count(), motion.count() - 6);
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

}  // namespace
}  // namespace inverse_dynamics_evaluation
