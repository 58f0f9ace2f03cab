// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <random>

#include "inverse_dynamics_evaluation/evaluator.hpp"
#include "joint_log.hpp"
#include "motion.hpp"
#include "two_joint_solver.hpp"

namespace inverse_dynamics_evaluation::effort_fit_test {

using Eigen::Index;

// A motion with torques of half the solver's inertia, friction and noise, which no cut-off mends; positions and
// velocities vibrate with that acceleration [rad/s^2], the efforts don't.
JointLog vibrating(double acceleration) {
  const Motion motion = sines(250.0, 20.0, {0.5, 1.0});
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0.0, 0.1);
  JointLog log;
  log.header_stamps = log.receive_stamps = (1e9 * motion.time).array().round().cast<std::int64_t>();
  log.q = motion.q;
  log.qd = motion.qd;
  log.effort = motion.qdd + 0.4 * motion.qd.array().sign().matrix();
  log.effort = log.effort.unaryExpr([&](double tau) { return tau + noise(generator); }).eval();
  for (const double frequency : {24.0, 31.0, 38.0}) {
    const double w = 2 * kPi * frequency;
    const Eigen::RowVectorXd phase = (w * motion.time.array() + frequency).transpose();
    log.q.rowwise() -= acceleration / (w * w) * phase.array().sin().matrix();
    log.qd.rowwise() -= acceleration / w * phase.array().cos().matrix();
  }
  return log;
}

EvaluationOptions options() {
  EvaluationOptions options;
  options.effort.option = kTorque;
  options.recording = "bag";
  return options;
}

TEST(EffortFit, TakesVibrationAwayThatEffortsLack) {
  const AccelerationReport found =
      evaluate(vibrating(5.0), TwoJointSolver(), options()).accelerations;
  EXPECT_GT(found.filter.choice.by_motion, 40);
  EXPECT_LT(found.filter.cutoff, 15);
  EXPECT_GT(found.filter.cutoff, 2 * 0.99);
  EXPECT_THAT(found.findings, ::testing::Contains(::testing::HasSubstr("chosen by the efforts")));
}

TEST(EffortFit, KeepsTheChoiceOfTheMotionWhereEffortsDoNotKnowBetter) {
  const AccelerationReport found =
      evaluate(vibrating(0.0), TwoJointSolver(), options()).accelerations;
  EXPECT_EQ(found.filter.cutoff, found.filter.choice.by_motion);
  EXPECT_EQ(found.filter.choice.gain, 0);
}

}  // namespace inverse_dynamics_evaluation::effort_fit_test
