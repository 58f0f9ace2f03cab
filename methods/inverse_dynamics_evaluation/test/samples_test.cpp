// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/samples.hpp"

#include <gmock/gmock.h>

#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "motion.hpp"

namespace inverse_dynamics_evaluation::samples_test {

using ::testing::Field;
using ::testing::HasSubstr;

// What was found, and what the table says of each sample.
struct Examined : SampleReport {
  Examined(std::unique_ptr<SampleTable> made, const SampleRules& rules)
      : SampleReport(examineSamples(*made, rules)), table(std::move(made)) {}

  std::unique_ptr<SampleTable> table;
  SampleTable::FlagColumn repeated = table->repeated, non_increasing = table->non_increasing,
                          start_transient = table->start_transient, isolated = table->isolated,
                          used = table->used, kept = table->kept;
  SampleTable::NumberColumn time = table->instant;
};

Examined examine(const Motion& motion, const SampleRules& rules = {}) {
  return {tableOf(motion.time, motion.q, motion.qd, motion.effort), rules};
}

auto piecesFrom(const std::vector<Eigen::Index>& firsts) {
  std::vector<::testing::Matcher<Piece>> matchers;
  for (const Eigen::Index first : firsts) matchers.emplace_back(Field(&Piece::first, first));
  return ::testing::ElementsAreArray(matchers);
}

TEST(ExamineSamples, FindsNothingWrongWithACleanRecording) {
  Motion motion = sines(125.0, 4.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  const Examined report = examine(motion);
  EXPECT_FALSE(report.repeated.any());
  EXPECT_FALSE(report.non_increasing.any());
  EXPECT_FALSE(report.start_transient.any());
  EXPECT_FALSE(report.isolated.any());
  EXPECT_TRUE(report.used.all());
  EXPECT_TRUE(report.kept.all());
  EXPECT_EQ(report.time_base, TimeBase::kStamps);
  EXPECT_EQ(report.time, motion.time);
  EXPECT_THAT(report.pieces, piecesFrom({0}));
  EXPECT_NEAR(report.period, 0.008, 1e-12);
  EXPECT_NEAR(report.stamped_period, 0.008, 1e-12);
  EXPECT_LT(report.jitter, 1e-9);
}

TEST(ExamineSamples, LeavesRepeatedSamplesOut) {
  Motion motion = sines(100.0, 4.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  motion = withRepeats(motion, 10);
  const Examined report = examine(motion);
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    EXPECT_EQ(report.repeated[k], k % 10 == 9) << k;
  }
  EXPECT_TRUE((report.used == !report.repeated).all());
  EXPECT_TRUE((report.kept == !report.repeated).all());
  EXPECT_EQ(report.time[9], report.time[8]);  // the instant of the sample it repeats

  SampleRules rules;
  rules.repeated = false;  // found all the same, not acted upon
  const Examined all = examine(motion, rules);
  EXPECT_TRUE((all.repeated == report.repeated).all());
  EXPECT_TRUE(all.used.all());
  EXPECT_TRUE(all.kept.all());
}

TEST(ExamineSamples, TakesASampleForRepeatedOnlyIfEverythingIs) {
  Motion motion = withRepeats(sines(100.0, 4.0, {0.5, 1.0}), 10);
  motion.effort(1, 19) += 1e-12;
  const Examined report = examine(motion);
  EXPECT_TRUE(report.repeated[9]);
  EXPECT_FALSE(report.repeated[19]);
  // without efforts, positions and velocities decide
  motion.effort.resize(0, 0);
  EXPECT_TRUE(examine(motion).repeated[19]);
}

TEST(ExamineSamples, DoesNotTakeRestForRepetition) {
  Motion motion = sines(100.0, 4.0, {0.5, 1.0});
  for (Eigen::Index k = 100; k < 200; ++k) {
    motion.q.col(k) = motion.q.col(100);
    motion.qd.col(k).setZero();
    motion.effort.col(k) = motion.effort.col(100);
  }
  EXPECT_FALSE(examine(motion).repeated.any());
}

TEST(ExamineSamples, LeavesStampsThatDoNotIncreaseOut) {
  Motion motion = sines(100.0, 4.0, {0.5, 1.0});
  motion.time[50] = motion.time[49];
  motion.time[80] = motion.time[70];  // later samples must pass sample 79 again
  SampleRules rules;
  rules.time_base = false;
  const Examined report = examine(motion, rules);
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    EXPECT_EQ(report.non_increasing[k], k == 50 || k == 80) << k;
    EXPECT_EQ(report.kept[k], !(k == 50 || k == 80)) << k;
  }
  EXPECT_NEAR(report.time[80], 0.80, 1e-12);  // between its neighbours

  rules.non_increasing = false;
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { examine(motion, rules); }),
      HasSubstr("samples: time: expected stamps that increase, got 2 of 401 that don't, the first "
                "in sample 51 (counted from 1)"));
}

TEST(ExamineSamples, ReplacesJitteringStampsByEqualDistances) {
  const Motion clean = sines(1000.0, 5.0, {0.5, 1.0});
  Motion motion = clean;
  addVelocityNoise(motion, 0.005, 1);
  jitterStamps(motion, 0.8, 2);
  const Examined report = examine(motion);
  EXPECT_EQ(report.time_base, TimeBase::kRegular);
  EXPECT_LT(report.disagreement[1], 0.2 * report.disagreement[0]);
  // exact but for where the first and the last stamp lie
  EXPECT_LT((report.time - clean.time).cwiseAbs().maxCoeff(), 0.001);
  EXPECT_GT(report.jitter, 2e-4);

  SampleRules rules;
  rules.time_base = false;
  EXPECT_EQ(examine(motion, rules).time_base, TimeBase::kStamps);
  EXPECT_EQ(examine(motion, rules).time, motion.time);
}

TEST(ExamineSamples, KeepsJitteringStampsThatAreRight) {
  // samples really taken at irregular instants
  Motion motion = sines(1000.0, 5.0, {0.5, 1.0});
  const Motion dense = sines(10000.0, 5.0, {0.5, 1.0});
  std::mt19937 generator(5);
  std::vector<Eigen::Index> samples;
  Eigen::VectorXd time(5000);
  for (Eigen::Index k = 0; k < 5000; ++k) {
    samples.push_back(10 * k + static_cast<Eigen::Index>(generator() % 8));
    time[k] = dense.time[samples.back()];
  }
  motion = pick(dense, samples, time);
  addVelocityNoise(motion, 0.005, 1);
  EXPECT_EQ(examine(motion).time_base, TimeBase::kStamps);
}

TEST(ExamineSamples, TellsMissedStatesFromARecorderThatIsTooFast) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.002, 1);

  // a state came too late: the repeat stands in its place
  Motion missed = withRepeats(motion, 12);
  jitterStamps(missed, 0.5, 3);
  EXPECT_EQ(examine(missed).time_base, TimeBase::kRegular);

  // a recorder of 100 Hz beside a robot of 96 Hz: each 25th message repeats, none is missed
  std::vector<Eigen::Index> samples;
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    samples.push_back(k - k / 25);
  }
  const Motion polled = pick(motion, samples, 0.96 * motion.time);
  const Examined report = examine(polled);
  EXPECT_EQ(report.time_base, TimeBase::kRegularFresh);
  EXPECT_EQ(report.repeated.count(), motion.count() / 25);
  EXPECT_NEAR(report.period, 0.01, 1e-4);
}

TEST(ExamineSamples, KeepsTheStampsWhereMessagesWereLost) {
  // equal distances would fit one interval, but not 50: the clock would run away
  Motion motion = sines(1000.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.002, 1);
  std::mt19937 generator(6);
  std::vector<Eigen::Index> samples;
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    if (generator() % 50 != 0) {
      samples.push_back(k);
    }
  }
  Eigen::VectorXd time(static_cast<Eigen::Index>(samples.size()));
  for (Eigen::Index k = 0; k < time.size(); ++k) {
    time[k] = motion.time[samples[static_cast<std::size_t>(k)]];
  }
  Motion lossy = pick(motion, samples, time);
  jitterStamps(lossy, 0.6, 4);
  const Examined report = examine(lossy);
  EXPECT_LT(report.disagreement[1], 0.8 * report.disagreement[0]);
  EXPECT_EQ(report.time_base, TimeBase::kStamps);
}

TEST(ExamineSamples, UsesSamplesOfEqualStampsIfEqualDistancesFit) {
  // messages that arrive in threes and are stamped on arrival
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  addVelocityNoise(motion, 0.002, 1);
  for (Eigen::Index k = 0; k + 2 < motion.count(); k += 3) {
    motion.time[k] = motion.time[k + 1] = motion.time[k + 2];
  }
  const Examined report = examine(motion);
  EXPECT_EQ(report.time_base, TimeBase::kRegular);
  EXPECT_GT(2 * report.non_increasing.count(), motion.count());
  EXPECT_TRUE(report.used.all());
}

TEST(ExamineSamples, DoesNotCountAStartTransient) {
  Motion motion = sines(50.0, 10.0, {0.5, 1.0});
  for (Eigen::Index k = 0; k < 6; ++k) {
    motion.effort(0, k) += k % 2 == 0 ? 8.0 : -8.0;
  }
  const Examined report = examine(motion);
  EXPECT_TRUE(report.start_transient.head(6).all());
  EXPECT_LE(report.start_transient.count(), 7);  // the jump back touches one more
  EXPECT_TRUE((report.kept == !report.start_transient).all());
  EXPECT_TRUE(report.used.all());

  SampleRules rules;
  rules.start_transient = false;
  EXPECT_TRUE(examine(motion, rules).kept.all());
  EXPECT_TRUE(examine(motion, rules).start_transient[0]);  // said all the same
}

TEST(ExamineSamples, TakesOnlyTheStartForAStartTransient) {
  Motion motion = sines(50.0, 10.0, {0.5, 1.0});
  for (Eigen::Index k = 200; k < 206; ++k) {
    motion.effort(0, k) += k % 2 == 0 ? 8.0 : -8.0;
  }
  EXPECT_FALSE(examine(motion).start_transient.any());
}

TEST(ExamineSamples, TakesNoMissedSampleForAStartTransient) {
  Motion motion = sines(125.0, 6.0, {0.5, 1.0});
  motion.effort = 3.0 * motion.qdd;  // smooth, so that a step stands out
  motion.q.col(20) = motion.q.col(19);
  motion.qd.col(20) = motion.qd.col(19);
  motion.effort.col(20) = motion.effort.col(19);
  const Examined report = examine(motion);
  EXPECT_TRUE(report.repeated[20]);
  EXPECT_FALSE(report.start_transient.any());
}

TEST(ExamineSamples, CutsAtGapsAndDropsShortPieces) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  motion.time.tail(motion.count() - 400).array() += 3.0;  // a gap before sample 400,
  motion.time.tail(motion.count() - 405).array() += 2.0;  // and another before sample 405
  const Examined report = examine(motion);
  EXPECT_THAT(report.pieces, piecesFrom({0, 405}));
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    EXPECT_EQ(report.isolated[k], k >= 400 && k < 405) << k;
  }
  EXPECT_TRUE((report.kept == !report.isolated).all());
  EXPECT_NEAR(report.period, 0.01, 1e-9);  // gaps aside

  SampleRules rules;
  rules.longest_gap = 5.0;
  EXPECT_THAT(examine(motion, rules).pieces, piecesFrom({0}));
}

TEST(ExamineSamples, SurvivesAFirstStampOfZero) {
  // a recorder that started before its clock was set
  Motion motion = sines(100.0, 5.0, {0.5, 1.0});
  motion.time.tail(motion.count() - 1).array() += 1.7e9;
  const Examined report = examine(motion);
  EXPECT_TRUE(report.isolated[0]);
  EXPECT_EQ(report.isolated.count(), 1);
  EXPECT_NEAR(report.period, 0.01, 1e-6);
}

TEST(ExamineSamples, TakesNoMotionForAStartTransient) {
  // all of the motion is in the first half second, and efforts are rough while the arm moves
  Motion motion = restingBut(1000.0, 10.0, 0.14, 0.28);
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    const double scale = motion.qd.col(k).isZero(0) ? 1.0 : 30.0;
    for (double& effort : motion.effort.col(k)) effort = scale * noise(generator);
  }
  EXPECT_LT(examine(motion).start_transient.count(), 220);  // 0.08 s of motion at most
}

TEST(ExamineSamples, GoesOnWhereAClockWasSet) {
  const Motion clean = sines(100.0, 20.0, {0.5, 1.0});
  for (const double by : {-5.0, -0.05, 0.1}) {
    Motion motion = clean;
    motion.time.tail(1000).array() += by;
    const Examined report = examine(motion);
    ASSERT_EQ(report.clock_steps.size(), 1U) << by;
    EXPECT_EQ(report.clock_steps[0].sample, 1001);
    EXPECT_NEAR(report.clock_steps[0].by, by, 1e-6);
    EXPECT_LT((report.time - clean.time).cwiseAbs().maxCoeff(), 1e-6) << by;
    EXPECT_TRUE(report.kept.all()) << by;
  }
}

TEST(ExamineSamples, CutsWhereAClockWasSetBackInAPause) {
  const Motion clean = sines(100.0, 20.0, {0.5, 1.0});
  std::vector<Eigen::Index> samples;
  for (Eigen::Index k = 0; k < clean.count(); ++k) {
    if (k < 1000 || k >= 1150) samples.push_back(k);
  }
  Eigen::VectorXd time(static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    time[static_cast<Eigen::Index>(i)] =
        0.01 * static_cast<double>(samples[i]) - (i < 1000 ? 0 : 4);
  }
  const Examined report = examine(pick(clean, samples, time));
  EXPECT_EQ(report.clock_steps.size(), 1U);
  EXPECT_THAT(report.pieces, piecesFrom({0, 1000}));
  EXPECT_TRUE(report.kept.all());
}

TEST(ExamineSamples, TakesNoLateMessageForAClockThatWasSet) {
  Motion motion = sines(100.0, 4.0, {0.5, 1.0});
  motion.time[80] = motion.time[70];
  motion.time[200] += 0.035;  // and those behind it arrive at once
  motion.time[201] += 0.026;
  motion.time[202] += 0.017;
  motion.time[300] += 0.1;
  EXPECT_TRUE(examine(motion).clock_steps.empty());
}

// Each sample followed by one of a publisher that says something else.
template <class Other>
Motion alternating(const Motion& motion, Other other) {
  std::vector<Eigen::Index> samples;
  Eigen::VectorXd time(2 * motion.count());
  for (Eigen::Index k = 0; k < motion.count(); ++k) {
    samples.insert(samples.end(), {k, k});
    time.segment<2>(2 * k) << motion.time[k], motion.time[k] + 0.003;
  }
  Motion both = pick(motion, samples, time);
  for (Eigen::Index k = 1; k < both.count(); k += 2) other(both, k);
  return both;
}

TEST(ExamineSamples, LeavesOutASecondPublisherThatStandsStill) {
  const Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  const auto still = [](Motion& both, Eigen::Index k) {
    both.qd.col(k).setZero();
    both.effort.col(k).setZero();
  };
  const auto at_start = [&](Motion& both, Eigen::Index k) {
    both.q.col(k) = both.q.col(0);
    both.qd.col(k).setZero();
  };
  for (const Motion& both : {alternating(motion, still), alternating(motion, at_start)}) {
    const Examined report = examine(both);
    EXPECT_EQ(report.second_source.count, motion.count());
    EXPECT_EQ(report.second_source.first, 1);
    for (Eigen::Index k = 0; k < both.count(); ++k) EXPECT_EQ(report.used[k], k % 2 == 0) << k;
  }

  Motion zeros = motion;
  for (const Eigen::Index k : {120, 305, 700}) {
    zeros.q.col(k).setZero();
    zeros.qd.col(k).setZero();
    zeros.effort.col(k).setZero();
  }
  EXPECT_EQ(examine(zeros).second_source.count, 3);
}

TEST(ExamineSamples, LeavesOutASampleNowAndThenOfAnotherMotion) {
  const Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  const Eigen::Index last = motion.count() - 1;
  for (const std::vector<Eigen::Index>& places : {std::vector<Eigen::Index>{120, 305, 306, 700},
                                                  {0, 305, last - 1, last},
                                                  {1, 2, 500, last}}) {
    Motion garbled = motion;
    for (const Eigen::Index k : places) {
      garbled.q.col(k).array() += 0.8;
      garbled.qd.col(k).array() *= -0.5;
    }
    const Examined report = examine(garbled);
    EXPECT_EQ(report.second_source.count, 4);
    EXPECT_EQ(report.second_source.first, places[0]);
    for (const Eigen::Index k : places) EXPECT_FALSE(report.used[k]) << k;
    EXPECT_EQ(report.used.count(), motion.count() - 4);
  }

  // a fast motion at a low rate, and a joint in degrees
  EXPECT_EQ(examine(sines(12.0, 20.0, {2.0, 3.0})).second_source.count, 0);
  Motion degrees = sines(20.0, 20.0, {0.5, 0.35});
  degrees.q.row(0) *= 180.0 / M_PI;
  EXPECT_EQ(examine(degrees).second_source.count, 0);
}

TEST(ExamineSamples, LeavesOutAPublisherThatRepeatsAnotherLater) {
  const Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  const Motion both = alternating(motion, [&](Motion& all, Eigen::Index k) {
    if (k < 6) return;
    all.q.col(k) = all.q.col(k - 5).eval();
    all.qd.col(k) = all.qd.col(k - 5).eval();
    all.effort.col(k) = all.effort.col(k - 5).eval();
  });
  const Examined report = examine(both);
  for (Eigen::Index k = 0; k < both.count(); ++k) EXPECT_EQ(report.used[k], k % 2 == 0) << k;
}

TEST(ExamineSamples, LeavesOutASampleBesideRepeatsThatIsLateItself) {
  Motion motion = sines(100.0, 10.0, {0.5, 1.0});
  const auto copy = [&](Eigen::Index from, Eigen::Index to) {
    motion.q.col(to) = motion.q.col(from).eval();
    motion.qd.col(to) = motion.qd.col(from).eval();
    motion.effort.col(to) = motion.effort.col(from).eval();
  };
  for (Eigen::Index k = 311; k < 315; ++k) copy(305, k);
  for (Eigen::Index k = 301; k < 311; ++k) copy(300, k);
  const Examined report = examine(motion);
  for (Eigen::Index k = 295; k < 320; ++k) EXPECT_EQ(report.used[k], k < 301 || k > 314) << k;
}

TEST(ExamineSamples, RefusesTwoPublishersThatMove) {
  const Motion both = alternating(sines(100.0, 10.0, {0.5, 1.0}), [](Motion& all, Eigen::Index k) {
    all.q.col(k) = -all.q.col(k).eval();
    all.qd.col(k) = -all.qd.col(k).eval();
  });
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(both); }),
              HasSubstr("samples: positions: expected those of one robot, got two sequences"));
}

TEST(ExamineSamples, RefusesWhatItCannotExamine) {
  const Motion motion = sines(100.0, 1.0, {0.5, 1.0});
  Motion bad = motion;
  bad.q(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }),
              HasSubstr("samples: q: expected finite numbers, got nan for joint 2 in sample 8"));
  bad = motion;
  bad.time[3] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }),
              HasSubstr("time: expected finite stamps, got inf in sample 4"));
  bad = motion;
  bad.time.conservativeResize(100);
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }),
              HasSubstr("time: expected 101 stamps, one per column of the samples, got 100"));
  bad = motion;
  bad.effort = bad.effort.topRows(1).eval();
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }),
              HasSubstr("effort: expected 2 joints x 101 samples"));
  EXPECT_THAT(errorOf<EvaluationError>([&] {
                tableOf(motion.time.head(1), motion.q.leftCols(1), motion.qd.leftCols(1),
                        Eigen::MatrixXd());
              }),
              HasSubstr("qd: expected 2 samples or more"));
  bad = motion;
  bad.time.reverseInPlace();
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }),
              HasSubstr("stamps of which half increase or more"));
  bad.time.setConstant(3.0);
  EXPECT_THROW(examine(bad), EvaluationError);
  bad = pick(motion, {0, 0, 0, 0, 0}, motion.time.head(5));
  EXPECT_THAT(errorOf<EvaluationError>([&] { examine(bad); }), HasSubstr("2 or more that differ"));
}

}  // namespace inverse_dynamics_evaluation::samples_test
