// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/output_stage.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::output_stage_test {

constexpr double kPeriod = 0.01;  // s

const std::vector<std::string> kNames = {"a", "b"};

TEST(OutputStage, EffortLimitsAreKeptAndReportedPerJoint) {
  OutputStage output({vec({10.0, 20.0}), {}}, kNames, "law");
  Eigen::VectorXd tau(2);
  EXPECT_EQ(output.apply(vec({-15.0, 15.0}), kPeriod, tau), Status::kSaturated);
  EXPECT_EQ(tau, vec({-10.0, 15.0}));
  EXPECT_TRUE(output.saturated()[0]);
  EXPECT_FALSE(output.saturated()[1]);
  EXPECT_FALSE(output.rateLimited().any());
  EXPECT_EQ(output.apply(vec({-10.0, 15.0}), kPeriod, tau), Status::kOk);
  EXPECT_FALSE(output.saturated().any());
}

TEST(OutputStage, TorqueChangesNoFasterThanItsRate) {
  OutputStage output({vec({10.0, 20.0}), vec({100.0, kInfinity})}, kNames, "law");
  Eigen::VectorXd tau(2);
  output.start(vec({2.0, 0.0}));
  EXPECT_EQ(output.apply(vec({8.0, 15.0}), kPeriod, tau), Status::kRateLimited);
  EXPECT_EQ(tau, vec({3.0, 15.0}));
  EXPECT_TRUE(output.rateLimited()[0]);
  EXPECT_FALSE(output.rateLimited()[1]);
  EXPECT_EQ(output.apply(vec({-8.0, -15.0}), kPeriod, tau), Status::kRateLimited);
  EXPECT_EQ(tau, vec({2.0, -15.0}));
  EXPECT_EQ(output.apply(vec({1.5, -15.0}), kPeriod, tau), Status::kOk);
  EXPECT_EQ(tau, vec({1.5, -15.0}));
}

TEST(OutputStage, AClockThatStandsOrJumpsAllowsNoChange) {
  OutputStage output({vec({10.0, 20.0}), vec({100.0, 100.0})}, kNames, "law");
  Eigen::VectorXd tau(2);
  output.start(vec({2.0, 1.0}));
  for (const double period : {0.0, -3.0, kNan, 1e9}) {
    EXPECT_EQ(output.apply(vec({8.0, 1.0}), period, tau), Status::kNoPeriod);
    EXPECT_EQ(tau, vec({2.0, 1.0}));
  }
}

TEST(OutputStage, FirstOutputIsNotLimitedInItsRateUnlessTheEffortIsKnown) {
  OutputStage output({vec({10.0, 20.0}), vec({100.0, 100.0})}, kNames, "law");
  Eigen::VectorXd tau(2);
  EXPECT_EQ(output.apply(vec({8.0, 15.0}), kPeriod, tau), Status::kOk);
  output.start(vec({kNan, 0.0}));
  EXPECT_EQ(output.apply(vec({-8.0, -15.0}), kPeriod, tau), Status::kOk);
  output.start();
  EXPECT_EQ(output.apply(vec({8.0, 15.0}), kPeriod, tau), Status::kOk);
  // beyond its limit, as a measured effort may be
  output.start(vec({30.0, 0.0}));
  EXPECT_EQ(output.apply(vec({8.0, 0.0}), kPeriod, tau), Status::kRateLimited);
  EXPECT_EQ(tau, vec({10.0, 0.0}));
}

TEST(OutputStage, BadLimitsAreRefused) {
  const auto text = [](const Eigen::VectorXd& effort, const Eigen::VectorXd& rate) {
    return thrownBy([&] { OutputStage({effort, rate}, kNames, "law"); });
  };
  EXPECT_EQ(text(vec({1.0, kInfinity}), {}), "");
  EXPECT_EQ(text({}, {}),
            "law: limits: effort: wrong size: expected 2 numbers [N m], got 0; give one for each "
            "of the joints a, b");
  EXPECT_EQ(text(vec({1.0, 0.0}), {}),
            "law: limits: effort: joint b: wrong value: expected a number above zero, or infinity "
            "for no limit [N m], got 0; correct this number");
  EXPECT_EQ(text(vec({1.0, 1.0}), vec({kNan, 1.0})),
            "law: limits: rate: joint a: wrong value: expected a number above zero, or infinity "
            "for no limit [N m/s], got nan; correct this number");
}

}  // namespace inverse_dynamics_control::output_stage_test
