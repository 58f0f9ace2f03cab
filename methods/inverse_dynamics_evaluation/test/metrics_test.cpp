// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation::metrics_test {

using ::testing::HasSubstr;

constexpr double kRounding = 1e-14;
const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Metrics, AreThoseWorkedByHand) {
  Eigen::MatrixXd measured(2, 4);
  measured << 0, 1, 2, 5,  //
      -1, -1, 1, 1;
  Eigen::MatrixXd computed(2, 4);
  computed << 1, 1, 0, 5,  // errors 1 0 -2 0
      0, 0, 2, 2;          // errors 1 1 1 1
  const std::vector<JointMetrics> all = metrics(computed, measured);
  ASSERT_EQ(all.size(), 2U);

  EXPECT_EQ(all[0].count, 4);
  EXPECT_NEAR(all[0].mae, 3.0 / 4.0, kRounding);
  EXPECT_NEAR(all[0].rmse, std::sqrt(5.0 / 4.0), kRounding);
  EXPECT_NEAR(all[0].nrmse, std::sqrt(5.0 / 4.0) / 5.0, kRounding);
  EXPECT_NEAR(all[0].bias, -1.0 / 4.0, kRounding);      // too little is computed
  EXPECT_NEAR(all[0].r2, 1.0 - 5.0 / 14.0, kRounding);  // mean 2: 4 + 1 + 0 + 9
  EXPECT_EQ(all[0].max_abs, 2.0);
  EXPECT_EQ(all[0].max_at, 2);
  EXPECT_EQ(all[0].measured_range, 5.0);

  EXPECT_NEAR(all[1].bias, 1.0, kRounding);
  EXPECT_NEAR(all[1].r2, 0.0, kRounding);  // as good as the mean would be
}

TEST(Metrics, OverAMaskAreThoseOfTheSelectedColumns) {
  const Eigen::MatrixXd measured = Eigen::MatrixXd::Random(2, 6);
  Eigen::MatrixXd computed = Eigen::MatrixXd::Random(2, 6);
  Mask mask(6);
  mask << false, true, false, true, true, false;
  Eigen::MatrixXd few_measured(2, 3);
  few_measured << measured.col(1), measured.col(3), measured.col(4);
  Eigen::MatrixXd few_computed(2, 3);
  few_computed << computed.col(1), computed.col(3), computed.col(4);
  computed(0, 0) = kNan;  // left out: may be anything
  const std::vector<JointMetrics> masked = metrics(computed, measured, mask);
  const std::vector<JointMetrics> few = metrics(few_computed, few_measured);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(masked[j].count, 3);
    EXPECT_EQ(masked[j].rmse, few[j].rmse);
    EXPECT_EQ(masked[j].r2, few[j].r2);
    EXPECT_EQ(masked[j].nrmse, few[j].nrmse);
    EXPECT_EQ(masked[j].max_abs, few[j].max_abs);
    EXPECT_TRUE(mask[masked[j].max_at]);
    EXPECT_EQ(std::abs(computed(static_cast<Eigen::Index>(j), masked[j].max_at) -
                       measured(static_cast<Eigen::Index>(j), masked[j].max_at)),
              masked[j].max_abs);
  }
}

TEST(Metrics, HaveNoNrmseAndNoR2WhereTheMeasuredTorqueNeverChanges) {
  const Eigen::MatrixXd measured = Eigen::MatrixXd::Constant(1, 7, 0.1);  // its mean is rounded
  const JointMetrics joint = metrics(Eigen::MatrixXd::Zero(1, 7), measured)[0];
  EXPECT_TRUE(std::isnan(joint.nrmse));
  EXPECT_TRUE(std::isnan(joint.r2));
  EXPECT_NEAR(joint.rmse, 0.1, kRounding);
  EXPECT_NEAR(joint.bias, -0.1, kRounding);
}

TEST(Metrics, KeepTheDigitsOfR2BesideALargeOffset) {
  Eigen::MatrixXd measured = Eigen::MatrixXd::Random(1, 1000);
  Eigen::MatrixXd computed = measured + 0.1 * Eigen::MatrixXd::Random(1, 1000);
  const double r2 = metrics(computed, measured)[0].r2;
  measured.array() += 1e6;
  computed.array() += 1e6;
  EXPECT_NEAR(metrics(computed, measured)[0].r2, r2, 1e-8);  // 1e6 costs six of sixteen digits
}

TEST(Metrics, RefuseWhatCannotBeCompared) {
  const Eigen::MatrixXd measured = Eigen::MatrixXd::Ones(2, 3);
  EXPECT_THAT(errorOf<EvaluationError>([&] { metrics(Eigen::MatrixXd::Ones(2, 4), measured); }),
              HasSubstr("metrics: computed: expected 2 joints x 3 samples as in measured, got 2 "
                        "joints x 4 samples"));
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { metrics(measured, measured, Mask::Constant(2, true)); }),
      HasSubstr("mask: expected 3 truth values, one per sample, got 2"));
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { metrics(measured, measured, Mask::Constant(3, false)); }),
      HasSubstr("got none of 3"));
  EXPECT_THROW(metrics(Eigen::MatrixXd(2, 0), Eigen::MatrixXd(2, 0)), std::invalid_argument);
  Eigen::MatrixXd bad = measured;
  bad(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(errorOf<EvaluationError>([&] { metrics(bad, measured); }),
              HasSubstr("computed: expected finite numbers, got inf for joint 2 in sample 3"));
  EXPECT_THAT(errorOf<EvaluationError>([&] { metrics(measured, bad); }),
              HasSubstr("metrics: measured: expected finite"));
}

TEST(Metrics, LoseNothingInALongRecording) {
  // added one by one, ten million times 0.1 is 1.6e-10 short of a million
  constexpr Eigen::Index kCount = 10'000'000;
  const Eigen::MatrixXd computed = Eigen::MatrixXd::Constant(1, kCount, 0.1);
  const Eigen::MatrixXd measured = Eigen::MatrixXd::Zero(1, kCount);
  const JointMetrics joint = metrics(computed, measured)[0];
  EXPECT_EQ(joint.count, kCount);
  EXPECT_NEAR(joint.bias, 0.1, kRounding);
  EXPECT_NEAR(joint.mae, 0.1, kRounding);
  EXPECT_NEAR(joint.rmse, 0.1, kRounding);
}

}  // namespace inverse_dynamics_evaluation::metrics_test
