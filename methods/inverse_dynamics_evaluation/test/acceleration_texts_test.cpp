// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "joint_log.hpp"

namespace inverse_dynamics_evaluation::acceleration_texts_test {

using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// A sine of 0.5 Hz, 10 s at 100 Hz.
JointLog sine() {
  constexpr Eigen::Index kCount = 1000;
  const double w = 3.14159265358979323846;
  JointLog log;
  log.header_stamps = Stamps::LinSpaced(kCount, 0, 10'000'000 * (kCount - 1));
  log.receive_stamps = log.header_stamps;
  const Eigen::RowVectorXd t = log.time().transpose();
  log.q = (w * t.array()).sin();
  log.qd = w * (w * t.array()).cos();
  log.effort = log.q;
  return log;
}

TEST(LogAccelerations, AreThoseOfTheMethodThatWasNamed) {
  const JointLog log = sine();
  const Eigen::VectorXd time = log.time();

  const LogAccelerations raw = logAccelerations(log, accelerationMethod("backward-difference"));
  EXPECT_EQ(raw.qdd, backwardDifference(time, log.qd));
  EXPECT_EQ(raw.summary, "backward-difference, no filter");

  const LogAccelerations given = logAccelerations(log, accelerationMethod("low-pass"), 5.0);
  LowPassOptions options;
  options.cutoff = 5.0;
  const auto table = tableOf(time, log.q, log.qd, log.effort);
  EXPECT_EQ(given.qdd, accelerationsOf(*table, AccelerationMethod::kLowPass, options).qdd);
  EXPECT_EQ(given.summary, "zero-phase low-pass, cut-off 5 Hz (given), then derivative");

  const LogAccelerations chosen = logAccelerations(log);
  EXPECT_EQ(chosen.qdd, accelerationsOf(*table, AccelerationMethod::kLowPass, {}).qdd);
  EXPECT_THAT(chosen.summary, HasSubstr("chosen from the data"));
  EXPECT_TRUE(chosen.findings.empty());
}

TEST(LogAccelerations, AreThoseRecordedIfThereAreAny) {
  JointLog log = sine();
  log.qdd = 7 * log.q;
  const LogAccelerations found = logAccelerations(log);
  EXPECT_EQ(found.qdd, log.qdd);
  EXPECT_EQ(found.summary, "given by the recording");
  EXPECT_EQ(logAccelerations(log, AccelerationMethod::kGiven).qdd, log.qdd);

  // unless something else is asked for
  EXPECT_EQ(logAccelerations(log, AccelerationMethod::kAuto, 5.0).summary,
            "zero-phase low-pass, cut-off 5 Hz (given), then derivative");
  EXPECT_NE(logAccelerations(log, AccelerationMethod::kLowPass).qdd, log.qdd);
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { logAccelerations(log, AccelerationMethod::kGiven, 5.0); }),
      HasSubstr("given has no cut-off, got 5 Hz"));
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { logAccelerations(sine(), AccelerationMethod::kGiven); }),
      HasSubstr("the recording gives none; expected another method, such as auto"));
}

TEST(LogAccelerations, SayWhatIsOddAboutTheSamples) {
  JointLog log = sine();
  for (Eigen::MatrixXd* numbers : {&log.q, &log.qd, &log.effort}) {
    numbers->col(500) = numbers->col(499);
  }
  log.header_stamps[700] = log.header_stamps[699] - 1'000'000;
  const LogAccelerations found = logAccelerations(log);
  EXPECT_THAT(
      found.findings,
      Contains("1 of 1000 samples repeat an earlier one (left out of the differentiation)"));
  EXPECT_THAT(found.findings,
              Contains("1 of 1000 samples have an equal or backward header stamp (left out of the "
                       "differentiation): the first is sample 701 at 6.989000000 s after "
                       "6.990000000 s"));
  EXPECT_THAT(logAccelerations(log, AccelerationMethod::kBackwardDifference).findings,
              Contains("1 of 1000 samples repeat an earlier one"));
}

TEST(LogAccelerations, SayThatThereIsAGap) {
  JointLog log = sine();
  const auto lose = [&](Eigen::Index count) {
    const Eigen::Index left = log.q.cols() - 700 - count;
    for (Eigen::MatrixXd* numbers : {&log.q, &log.qd, &log.effort}) {
      numbers->middleCols(700, left) = numbers->rightCols(left).eval();
      numbers->conservativeResize(Eigen::NoChange, 700 + left);
    }
    log.header_stamps.segment(700, left) = log.header_stamps.tail(left).eval();
    log.header_stamps.conservativeResize(700 + left);
    log.receive_stamps = log.header_stamps;
  };
  lose(3);
  EXPECT_THAT(logAccelerations(log).findings, Not(Contains(HasSubstr("gap"))));
  lose(11);
  EXPECT_THAT(logAccelerations(log).findings,
              Contains("no sample for 0.15 s after sample 700 at 6.990000000 s, the longest gap: "
                       "samples around it bridge it"));
  log = sine();
  log.header_stamps.tail(300).array() += 10'000'000'000;
  EXPECT_THAT(logAccelerations(log).findings,
              Contains("1 gap in the recording: no sample for 10 s after sample 700 at 6.990000000 "
                       "s; each side is filtered by itself"));
  log.header_stamps.tail(100).array() += 2'000'000'000;
  EXPECT_THAT(logAccelerations(log, AccelerationMethod::kBackwardDifference).findings,
              Contains("2 gaps in the recording: no sample for 10 s after sample 700 at "
                       "6.990000000 s (the longest)"));
}

TEST(LogAccelerations, SayWhichSampleCannotBeRight) {
  JointLog log = sine();
  EXPECT_THAT(logAccelerations(log).findings, Not(Contains(HasSubstr("jumps and returns"))));
  log.qd(0, 300) += 0.5;
  EXPECT_THAT(logAccelerations(log).findings,
              Contains(ContainsRegex("sample 301 at 3.0+ s: .* joint 1 .* jumps and returns")));
  log = sine();
  log.q(0, 700) -= 0.1;
  EXPECT_THAT(logAccelerations(log).findings, Contains(HasSubstr("sample 701 at 7.0")));
  log.q.rightCols(300).array() -= 1.0;  // a jump that stays isn't one wrong sample
  EXPECT_THAT(logAccelerations(log).findings, Not(Contains(HasSubstr("jumps and returns"))));
  log = sine();
  log.qd.rightCols(300).array() -= 1.0;  // nor is one that changes the slope, as a gap does
  log.qd(0, 700) -= 0.25;
  EXPECT_THAT(logAccelerations(log).findings, Not(Contains(HasSubstr("jumps and returns"))));
}

TEST(LogAccelerations, ChooseTheCutOffFromLongPieces) {
  // half a second of motion after a gap would seem faster than it is
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.003);
  JointLog log = sine();
  for (double& value : log.qd.reshaped()) value += noise(random);
  const double whole = logAccelerations(log).filter.cutoff;
  log.header_stamps.tail(50).array() += 2'000'000'000;
  log.receive_stamps = log.header_stamps;
  const double with_gap = logAccelerations(log).filter.cutoff;
  EXPECT_LT(with_gap, 1.5 * whole);
  EXPECT_GT(with_gap, whole / 1.5);
}

TEST(LogAccelerations, SayWhatTheDataCannotTell) {
  // one half of a sine of 0.5 Hz in a minute of rest
  JointLog log = sine();
  constexpr Eigen::Index kCount = 6000;
  log.header_stamps = log.receive_stamps = Stamps::LinSpaced(kCount, 0, 10'000'000 * (kCount - 1));
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, 0.002);
  const double w = 3.14159265358979323846;
  const Eigen::RowVectorXd t = log.time().transpose();
  const Eigen::ArrayXXd phase = (w * (t.array() - 30.0)).max(0.0).min(w);
  log.q = 1.0 - phase.cos();
  log.qd = (w * phase.sin()).unaryExpr([&](double x) { return x + noise(generator); });
  log.effort = log.qd;
  EXPECT_THAT(
      logAccelerations(log).findings,
      Contains(ContainsRegex("the arm rests for 9[0-9](\\.[0-9])? % of the time: the cut-off "
                             "was chosen from the motion alone")));
  EXPECT_TRUE(logAccelerations(log, AccelerationMethod::kLowPass, 5.0).findings.empty());

  log.qd.setZero();
  log.q.setZero();
  EXPECT_THAT(
      logAccelerations(log).findings,
      Contains("the chosen cut-off, 40 Hz, is the highest possible: the data don't distinguish "
               "noise from motion"));
}

TEST(LogAccelerations, RefuseAnUnknownMethodAndACutOffWithoutAFilter) {
  EXPECT_THAT(
      errorOf<EvaluationError>([] { accelerationMethod("savgol"); }),
      HasSubstr("expected one of auto, low-pass, given, backward-difference, got 'savgol'"));
  EXPECT_THAT(errorOf<EvaluationError>(
                  [] { logAccelerations(sine(), AccelerationMethod::kBackwardDifference, 5.0); }),
              HasSubstr("backward-difference has no cut-off, got 5 Hz"));
}

}  // namespace inverse_dynamics_evaluation::acceleration_texts_test
