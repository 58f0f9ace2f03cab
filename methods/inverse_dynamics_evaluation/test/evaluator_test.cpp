// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/evaluator.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "joint_log.hpp"
#include "two_joint_solver.hpp"

namespace inverse_dynamics_evaluation::evaluator_test {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRounding = 1e-12;

MatrixXd gravityOf(const MatrixXd& q) {
  MatrixXd gravity = MatrixXd::Constant(2, q.cols(), 20);
  gravity.row(0) = 10 * q.row(0).array().cos();
  return gravity;
}

// Torques of the motion, with recorded accelerations, and 0.25 and -0.5 N m more; longer than the
// blocks that a solver gets.
JointLog recorded(Index count = 10000) {
  JointLog log;
  log.header_stamps = Stamps::LinSpaced(count, 0, 10'000'000 * (count - 1));
  log.receive_stamps = log.header_stamps;
  const Eigen::RowVectorXd t = log.time().transpose();
  log.q.resize(2, count);
  log.q << t.array().sin().matrix(), t.array().cos().matrix();
  log.qd.resize(2, count);
  log.qd << t.array().cos().matrix(), -t.array().sin().matrix();
  log.qdd = -log.q;
  log.effort = Eigen::Vector2d(2, 3).asDiagonal() * log.qdd + gravityOf(log.q);
  log.effort.row(0).array() += 0.25;
  log.effort.row(1).array() -= 0.5;
  return log;
}

EvaluationOptions options(const std::string& effort) {
  EvaluationOptions options;
  options.effort.option = effort;
  options.effort.where = "robot two_joints";
  options.effort.gains_from = "two_joints.yaml";
  options.effort.plugin = "package/TwoJointSolver";
  options.recording = "bag";
  options.topic = "/joint_states";
  options.units = {"N m", "N"};
  options.notes = {"the reader notes"};
  return options;
}

TEST(Evaluate, ComparesComputedWithMeasuredTorques) {
  const JointLog log = recorded();
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), options(kTorque));
  EXPECT_EQ(evaluation.table->size(), 10000);
  EXPECT_EQ(evaluation.joint_names, (std::vector<std::string>{"a", "b"}));
  EXPECT_NEAR(evaluation.errors[0].bias, -0.25, kRounding);
  EXPECT_NEAR(evaluation.errors[1].rmse, 0.5, kRounding);
  EXPECT_EQ(evaluation.errors[0].count, 10000);
  EXPECT_EQ(evaluation.accelerations.summary, "given by the recording");
  EXPECT_EQ(evaluation.table->qdd, log.qdd);
  EXPECT_EQ(evaluation.table->measured, log.effort);
  const std::vector<JointMetrics> whole =
      metrics(evaluation.table->computed, evaluation.table->measured);
  EXPECT_NEAR(evaluation.errors[0].r2, whole[0].r2, kRounding);
  EXPECT_EQ(evaluation.notes, (std::vector<std::string>{"the solver warns", "the reader notes"}));
}

TEST(Evaluate, TakesAccelerationsOfTheLowPassWhereACutOffIsGiven) {
  const JointLog log = recorded();
  EvaluationOptions filtered = options(kTorque);
  filtered.cutoff = 5.0;
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), filtered);
  const LogAccelerations expected = logAccelerations(log, AccelerationMethod::kLowPass, 5.0);
  EXPECT_EQ(evaluation.table->qdd, expected.qdd);
  EXPECT_EQ(evaluation.accelerations.method, AccelerationMethod::kLowPass);
  EXPECT_EQ(evaluation.accelerations.filter.cutoff, 5.0);
}

TEST(Evaluate, RefusesSeriesOfOtherLengthsThanThePositions) {
  const TwoJointSolver solver;
  const auto refusal = [&](const JointLog& log) {
    return errorOf<EvaluationError>([&] { evaluate(log, solver, options(kTorque)); });
  };
  JointLog log = recorded(200);
  log.receive_stamps = Stamps::LinSpaced(100, 0, 99);
  EXPECT_EQ(
      refusal(log),
      "bag: /joint_states: samples: time: expected 200 stamps, one per column of the samples, "
      "got 100; a sample is a column");
  log = recorded(200);
  log.qdd.conservativeResize(Eigen::NoChange, 100);
  EXPECT_EQ(refusal(log),
            "bag: /joint_states: samples: qdd: expected 2 joints x 200 samples as in qd, got 2 "
            "joints x 100 samples; a sample is a column");
  EXPECT_THAT(refusal(JointLog()), HasSubstr("expected 2 samples or more"));
}

TEST(Evaluate, CountsSamplesOfShortPiecesWhereNothingIsFiltered) {
  for (const auto method : {AccelerationMethod::kGiven, AccelerationMethod::kBackwardDifference}) {
    EvaluationOptions unfiltered = options(kTorque);
    unfiltered.method = method;
    const Evaluation evaluation = evaluate(recorded(5), TwoJointSolver(), unfiltered);
    EXPECT_EQ(evaluation.errors_of_kept[0].count, 5);
    EXPECT_EQ(evaluation.accelerations.samples.counts.isolated, 0);
  }
}

TEST(Evaluate, LeavesSamplesOutOfTheSecondMetricsAlone) {
  JointLog log = recorded(2000);
  for (Index k = 10; k < 2000; k += 10) {  // a driver that repeats itself, with another effort
    log.q.col(k) = log.q.col(k - 1);
    log.qd.col(k) = log.qd.col(k - 1);
    log.effort.col(k) = log.effort.col(k - 1);
  }
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), options(kTorque));
  EXPECT_EQ(evaluation.errors[0].count, 2000);
  EXPECT_EQ(evaluation.errors_of_kept[0].count, 1801);
  EXPECT_THAT(evaluation.notes, Contains(HasSubstr("199 of 2000 samples repeat an earlier one")));
}

TEST(Evaluate, LeavesSamplesOfASecondSourceOutOfAllMetrics) {
  JointLog log = recorded(2000);
  for (const Index k : {400, 900, 1300}) {
    log.q.col(k).setZero();
    log.qd.col(k).setZero();
    log.effort.col(k).setZero();
  }
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), options(kTorque));
  EXPECT_EQ(evaluation.errors[0].count, 1997);
  EXPECT_EQ(evaluation.errors[0].rmse, evaluation.errors_of_kept[0].rmse);
}

TEST(Evaluate, TakesCurrentsTimesDriveGains) {
  JointLog log = recorded();
  const MatrixXd torques = log.effort;
  log.effort = Eigen::Vector2d(0.1, 0.2).asDiagonal() * torques;
  EvaluationOptions currents = options(kCurrent);
  currents.effort.drive_gains = {10, 5};
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), currents);
  EXPECT_NEAR(evaluation.errors[0].bias, -0.25, kRounding);
  EXPECT_LT((evaluation.table->measured - torques).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_EQ(evaluation.effort.summary(), "current, as given, with drive gains 10 5 N m/A");
}

TEST(Evaluate, LeavesGravityOutOfBothWhereEffortsAreWithoutIt) {
  JointLog log = recorded();
  log.effort -= gravityOf(log.q);
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), options(kTorqueWithoutGravity));
  EXPECT_NEAR(evaluation.errors[0].bias, -0.25, kRounding);
  EXPECT_NEAR(evaluation.table->computed(1, 0), -3, kRounding);
  EXPECT_FALSE(evaluation.effort.verdict.has_value());
  EXPECT_THAT(evaluation.notes, Contains("computed torques are shown without gravity, as efforts "
                                         "were recorded"));
}

TEST(Evaluate, TakesAVerdictOfTheDataWhereEffortsAreAuto) {
  const EvaluationOptions given = options(kAutomatic);
  const TwoJointSolver solver;
  Evaluation told = readMotion(recorded(200), solver, given);
  computeTorques(told, solver, given);
  EXPECT_EQ(told.effort.meaning, kAutomatic);
  EXPECT_NEAR(told.table->computed(1, 0), 3 * told.table->qdd(1, 0) + 20, kRounding);
  compareTorques(told, solver, given, {kTorqueWithoutGravity, true, "torque is far off", ""});
  EXPECT_EQ(told.effort.summary(),
            "torque without gravity, found from the data; sure: torque is far off");
  EXPECT_NEAR(told.table->computed(1, 0), 3 * told.table->qdd(1, 0), kRounding);
  const Evaluation without = evaluate(recorded(200), solver, given);
  EXPECT_EQ(without.effort.summary(), "torque, as the run configuration says; not sure");
  EXPECT_THAT(without.notes, Contains(HasSubstr("`ids evaluate` does; taken as torque, as the run "
                                                "configuration says")));
}

TEST(EffortOfData, FallsBackOnWhatIsStated) {
  EffortOptions options;
  options.configuration = kTorqueWithoutGravity;
  EXPECT_EQ(effortOfData({kTorque, true, "", ""}, options).stated_by, "found from the data");
  const EffortVerdict open = {kTorque, false, "", "they are alike"};
  EXPECT_EQ(effortOfData(open, options).meaning, kTorqueWithoutGravity);
  options.format = kTorque;
  EXPECT_EQ(effortOfData(open, options).stated_by, "as the recording's format says");
  options.format.clear();
  options.configuration = kAutomatic;
  const Effort effort = effortOfData(open, options);
  EXPECT_EQ(effort.summary(), "torque, as nothing is stated; not sure");
  EXPECT_THAT(effortNotes(effort, options, true, {}),
              ElementsAre(HasSubstr("all recorded efforts are zero"),
                          "the data don't determine what effort means: they are alike; taken as "
                          "torque, as nothing is stated"));
}

TEST(Evaluate, ComputesTorquesWhereNoEffortsAreRecorded) {
  JointLog log = recorded(50);
  log.effort.resize(0, 0);
  const Evaluation evaluation = evaluate(log, TwoJointSolver(), options(kTorque));
  EXPECT_EQ(evaluation.table->measured.size(), 0);
  EXPECT_TRUE(evaluation.errors.empty());
  EXPECT_NEAR(evaluation.table->computed(1, 0), 3 * log.qdd(1, 0) + 20, kRounding);
}

TEST(Evaluate, RefusesWhatCannotBeEvaluated) {
  const TwoJointSolver solver;
  EvaluationOptions given = options(kTorque);
  given.method = AccelerationMethod::kGiven;
  JointLog log = recorded(50);
  log.qdd.resize(0, 0);
  EXPECT_EQ(errorOf<EvaluationError>([&] { evaluate(log, solver, given); }),
            "bag: /joint_states: accelerations: the recording gives none; expected another method, "
            "such as auto");
  log = recorded(50);
  log.qdd(1, 7) = 1e13;
  EXPECT_EQ(errorOf<EvaluationError>([&] { evaluate(log, solver, options(kTorque)); }),
            "bag: sample 8: computed torque of joint b: expected at most 1e+12 N, got 3e+13; check "
            "masses, gravity and units");
  log.qdd(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(evaluate(log, solver, options(kTorque)), EvaluationError);
  EvaluationOptions without_units = options(kTorque);
  without_units.units.clear();
  EXPECT_EQ(errorOf<EvaluationError>([&] { evaluate(log, solver, without_units); }),
            "bag: sample 8: computed torque of joint a: expected at most 1e+12, got nan; check "
            "masses, gravity and units");
  without_units.units = {"N m"};
  EXPECT_THROW(evaluate(log, solver, without_units), EvaluationError);
  EvaluationOptions another_robots = options(kCurrent);
  another_robots.effort.drive_gains = {1.0};
  EXPECT_THROW(evaluate(recorded(200), solver, another_robots), EvaluationError);
  EXPECT_EQ(errorOf<EvaluationError>([&] { evaluate(log, solver, options("force")); }),
            "effort, as given: expected one of torque, current, torque_without_gravity, auto, got "
            "'force'");
  EXPECT_THAT(errorOf<ConfigurationError>([&] { evaluate(log, solver, options(kCurrent)); }),
              HasSubstr("robot two_joints: effort means current, as given: expected drive gains "
                        "[N m/A], got none from two_joints.yaml nor from package/TwoJointSolver"));
}

TEST(Effort, IsStatedByWhatTheProgramIsConfiguredBy) {
  EffortOptions node;
  node.configuration = kCurrent;
  node.where = "parameter 'effort'";
  node.gains_from = "parameter 'drive_gains'";
  node.plugin = "package/Solver";
  node.configured_by = "the node's configuration";
  EXPECT_EQ(errorOf<ConfigurationError>([&] { statedEffort(node); }),
            "parameter 'effort': effort means current, as the node's configuration says: expected "
            "drive gains [N m/A], got none from parameter 'drive_gains' nor from package/Solver; "
            "give drive_gains (ids: --drive-gains), one per joint, or put them into the node's "
            "configuration");
  node.drive_gains = {2, 3};
  const Effort effort = statedEffort(node);
  EXPECT_EQ(effort.summary(),
            "current, as the node's configuration says, with drive gains 2 3 N m/A");
  EXPECT_THAT(
      effortNotes(effort, node, false, {4, 5}),
      Contains("drive gains are those of the node's configuration; the solver's own are 4 5 "
               "N m/A"));
}

TEST(DriveGains, AreOnePositiveNumberPerJoint) {
  const TwoJointSolver solver;
  EXPECT_TRUE(driveGains({}, "file.yaml: drive_gains", solver).empty());
  EXPECT_EQ(driveGains({2, 3}, "file.yaml: drive_gains", solver), (std::vector<double>{2, 3}));
  EXPECT_EQ(errorOf<ConfigurationError>([&] { driveGains({2}, "file.yaml: drive_gains", solver); }),
            "file.yaml: drive_gains: expected 2 numbers, one per joint of the chain (a, b), got 1");
  EXPECT_EQ(errorOf<ConfigurationError>([&] {
              driveGains({2, -3}, "file.yaml: drive_gains", solver);
            }),
            "file.yaml: drive_gains: expected numbers above zero [N m/A], got 2 -3");
}

TEST(RulesWithout, SwitchOffTheRulesThatAreNamed) {
  EXPECT_FALSE(rulesWithout({"repeated"}).repeated);
  EXPECT_TRUE(rulesWithout({"repeated"}).time_base);
  EXPECT_FALSE(rulesWithout({"non-increasing"}).non_increasing);
  EXPECT_FALSE(rulesWithout({"time-base"}).time_base);
  EXPECT_FALSE(rulesWithout({"start-transient"}).start_transient);
  EXPECT_THAT(errorOf<EvaluationError>([] { rulesWithout({"all"}); }), HasSubstr("got 'all'"));
}

}  // namespace inverse_dynamics_evaluation::evaluator_test
