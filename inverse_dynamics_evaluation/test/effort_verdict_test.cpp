// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/effort_verdict.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/effort.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"

namespace inverse_dynamics_evaluation::effort_verdict_test {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kRounding = 1e-12;

// Computed torques of two joints; gravity doesn't load the first.
struct Arm {
  explicit Arm(Index count = 2000) {
    const Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(count, 0, 20);
    gravity = MatrixXd::Zero(2, count);
    gravity.row(1) = 60 * (0.7 * t.array() + 1).cos();
    computed = gravity;
    computed.row(0) += MatrixXd(20 * (3.1 * t.array() + 2).sin());
    computed.row(1) += MatrixXd(30 * (3.1 * t.array()).sin());
  }
  EffortVerdict verdict(const MatrixXd& effort, const std::vector<double>& gains = {}) const {
    return compareMeanings(computed, gravity, effort, gains, Mask::Constant(computed.cols(), true));
  }
  MatrixXd gravity, computed;
};

TEST(EffortSums, AllocateNothingForEachSample) {
  namespace conformance = inverse_dynamics_solver::conformance;
  if (!conformance::kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted here";
  const Arm arm;
  EffortSums sums(arm.computed.cols(), 2, {1.0, 2.0});
  const conformance::AllocationGuard guard;
  sums.add(arm.computed, arm.gravity, arm.computed);
  EXPECT_LE(guard.count(), 1);
}

TEST(EffortVerdict, HasTheValuesWorkedByHand) {
  MatrixXd computed = MatrixXd::Zero(2, 200);
  computed.row(0) = MatrixXd::Constant(1, 200, -4);
  for (Index k = 0; k < 200; k += 2) {
    computed(0, k) = 4;
  }
  MatrixXd gravity = MatrixXd::Zero(2, 200);
  gravity.row(0).setConstant(3);
  MatrixXd effort = computed;
  effort.row(0).array() += 1;
  const EffortVerdict verdict =
      compareMeanings(computed, gravity, effort, {}, Mask::Constant(200, true));
  // errors of the first joint are 1 and 4 of a range of 8; the second's are nothing, and the same
  ASSERT_EQ(verdict.candidates.size(), 2U);
  EXPECT_EQ(verdict.best(), kTorque);
  EXPECT_NEAR(verdict.candidates[0].error, 1.0 / 8.0, kRounding);
  EXPECT_NEAR(verdict.candidates[1].error, 4.0 / 8.0, kRounding);
  EXPECT_NEAR(verdict.candidates[1].margin, 2.0, kRounding);
  EXPECT_EQ(verdict.candidates[1].worse_in, 20);
  EXPECT_EQ(verdict.summary(),
            "torque is 12 % of the range off, torque_without_gravity 50 % (worse in 20 of 20 "
            "stretches, 2 times); current wasn't considered, as no drive gains are known");
}

TEST(EffortVerdict, RecognisesEachMeaning) {
  const Arm arm;
  const Eigen::Vector2d gains(10, 12);
  const std::vector<double> known = {10, 12};
  EXPECT_EQ(arm.verdict(arm.computed, known).best(), kTorque);
  EXPECT_EQ(arm.verdict(arm.computed - arm.gravity, known).best(), kTorqueWithoutGravity);
  const MatrixXd currents = gains.cwiseInverse().asDiagonal() * arm.computed;
  EXPECT_EQ(arm.verdict(currents, known).best(), kCurrent);
  EXPECT_TRUE(arm.verdict(currents, known).sure);
  EXPECT_EQ(arm.verdict(currents).reason, "no meaning fits");  // without gains
}

TEST(EffortVerdict, DoesNotTakeGravityOfAnotherDirectionForNone) {
  const Arm arm;
  const MatrixXd moving = 4 * (arm.computed - arm.gravity);
  const MatrixXd computed = moving + arm.gravity;
  const Mask all = Mask::Constant(2000, true);
  const EffortVerdict ceiling =
      compareMeanings(computed, arm.gravity, moving - arm.gravity, {}, all);
  EXPECT_EQ(ceiling.best(), kTorqueWithoutGravity);  // half as wrong as with gravity upside down
  EXPECT_EQ(ceiling.reason, "no meaning fits");
  EXPECT_TRUE(compareMeanings(computed, arm.gravity, moving, {}, all).sure);
}

TEST(EffortVerdict, IsNotSureWhereGravityDoesNotLoadTheJoints) {
  Arm arm;
  arm.computed -= arm.gravity;
  arm.gravity *= 1e-6;
  const EffortVerdict verdict = arm.verdict(arm.computed);
  EXPECT_FALSE(verdict.sure);
  EXPECT_THAT(verdict.rivals(), ElementsAre(kTorqueWithoutGravity));
  EXPECT_THAT(verdict.reason,
              HasSubstr("can't be told apart, as gravity hardly loads the joints in this motion"));
}

TEST(EffortVerdict, NeedsEnoughSamplesThatCountAndAreFinite) {
  Arm arm;
  MatrixXd effort = arm.computed;
  effort(0, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(arm.verdict(effort).sure);
  Mask few = Mask::Constant(2000, false);
  few.head(100).setConstant(true);
  const EffortVerdict verdict = compareMeanings(arm.computed, arm.gravity, effort, {}, few);
  EXPECT_EQ(verdict.reason, "99 valid samples are too few, 100 are needed");
  EXPECT_EQ(EffortSums(0, 2, {}).verdict().stretches, 1);
}

TEST(EffortVerdict, RefusesMasksAndGainsOfOtherSizes) {
  const Arm arm;
  const auto refused = [&](const std::vector<double>& gains, Index samples) {
    return errorOf<EvaluationError>([&] {
      compareMeanings(arm.computed, arm.gravity, arm.computed, gains,
                      Mask::Constant(samples, true));
    });
  };
  EXPECT_EQ(refused({}, 1000),
            "meanings of effort: mask: expected 2000 truth values, one per sample, got 1000; take "
            "the mask of the same recording");
  EXPECT_EQ(refused({}, 3000).substr(0, 24), "meanings of effort: mask");
  EXPECT_EQ(refused({1.0}, 2000),
            "meanings of effort: drive gains: expected 2 numbers, one per joint, got 1; take those "
            "of the same robot");
}

TEST(EffortSums, OfPartsAreThoseOfTheWhole) {
  const Arm arm(1234);
  const MatrixXd effort = (arm.computed.array() + 1).matrix();
  EffortSums sums(1234, 2, {});
  for (Index begin = 0; begin < 1234; begin += 100) {
    const Index count = std::min<Index>(100, 1234 - begin);
    sums.add(arm.computed.middleCols(begin, count), arm.gravity.middleCols(begin, count),
             effort.middleCols(begin, count));
  }
  EXPECT_EQ(sums.verdict().summary(), arm.verdict(effort).summary());
}

TEST(EffortOfData, FallsBackOnWhatIsStated) {
  const Arm arm;
  EffortOptions options;
  EXPECT_THAT(effortOfData(arm.verdict(arm.computed), options).summary(),
              StartsWith("torque, found from the data; sure: torque is"));
  const EffortVerdict open = arm.verdict(MatrixXd::Zero(2, 2000));
  ASSERT_FALSE(open.sure);
  options.configuration = kTorqueWithoutGravity;
  EXPECT_EQ(effortOfData(open, options).meaning, kTorqueWithoutGravity);
  options.format = kTorque;
  EXPECT_EQ(effortOfData(open, options).stated_by, "as the recording's format says");
  options.format.clear();
  options.configuration = kAutomatic;
  const Effort effort = effortOfData(open, options);
  EXPECT_THAT(effort.summary(), StartsWith("torque, as nothing is stated; not sure: "));
  EXPECT_THAT(effortNotes(effort, options, true, {}),
              ElementsAre(HasSubstr("all recorded efforts are zero"),
                          StartsWith("the data don't determine what effort means: ")));
}

}  // namespace inverse_dynamics_evaluation::effort_verdict_test
