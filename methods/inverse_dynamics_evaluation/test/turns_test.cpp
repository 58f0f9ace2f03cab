// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation::turns_test {

using chain_dynamics::JointType;
using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kTurn = 6.283185307179586;
constexpr double kPeriod = 0.02;     // s
constexpr double kRounding = 1e-12;  // of a dozen turns
constexpr Index kCount = 200;

// Three joints turn at 20, -20 and 0.5 rad/s from q0 on.
std::unique_ptr<SampleTable> samples(double q0 = 1.0, double period = kPeriod) {
  const Eigen::VectorXd time = period * Eigen::VectorXd::LinSpaced(kCount, 0, kCount - 1);
  const MatrixXd qd = Eigen::Vector3d(20.0, -20.0, 0.5).replicate(1, kCount);
  return tableOf(time, qd * time.asDiagonal() + MatrixXd::Constant(3, kCount, q0), qd, MatrixXd());
}

void report(SampleTable& table, double low, double turn = kTurn) {
  table.q = table.q.unaryExpr([=](double q) { return q - turn * std::floor((q - low) / turn); });
}

std::vector<std::string> unwrap(SampleTable& table, JointType type) {
  return unwrapPositions(table, std::vector<JointType>(3, type), {"a", "b", "c"});
}

TEST(UnwrapPositions, PositionsWithinATurnGoOnAsUnboundedOnes) {
  for (const double low : {-0.5 * kTurn, 0.0}) {
    const auto table = samples();
    report(*table, low);
    EXPECT_TRUE(unwrap(*table, JointType::kContinuous).empty());
    EXPECT_LT((table->q - samples()->q).cwiseAbs().maxCoeff(), kRounding);
  }
}

TEST(UnwrapPositions, UnboundedPositionsStayBitForBit) {
  const auto table = samples(30.0);
  unwrap(*table, JointType::kContinuous);
  EXPECT_EQ(table->q, samples(30.0)->q);
}

TEST(UnwrapPositions, ARevoluteJointKeepsItsPositionsAndItsJumpsAreNoted) {
  const auto table = samples();
  report(*table, -0.5 * kTurn);
  const MatrixXd q = table->q;
  Index jumps = 0, first = 0;
  for (Index k = 1; k < kCount; ++k) {
    if (q(0, k) < q(0, k - 1) && jumps++ == 0) first = k + 1;
  }
  const std::vector<JointType> types = {JointType::kRevolute, JointType::kPrismatic,
                                        JointType::kRevolute};
  EXPECT_THAT(unwrapPositions(*table, types, {"a", "b", "c"}),
              ElementsAre(HasSubstr("positions of a jump by a whole turn " + std::to_string(jumps) +
                                    " times, first in sample " + std::to_string(first))));
  EXPECT_EQ(table->q, q);
}

TEST(UnwrapPositions, ALongJumpThatVelocitiesExplainIsNoWholeTurn) {
  // so few samples that a joint really moves by 7 rad in between
  EXPECT_TRUE(unwrap(*samples(0.0, 0.35), JointType::kRevolute).empty());
}

TEST(UnwrapPositions, PositionsThatVelocityConfirmStay) {
  const auto table = samples();
  const double degrees = 57.29577951308232 / 4.0;  // 5.7 from sample to sample
  table->q *= degrees, table->qd *= degrees;
  const MatrixXd q = table->q;
  unwrap(*table, JointType::kContinuous);
  EXPECT_EQ(table->q, q);
}

TEST(UnwrapPositions, PositionsInDegreesStay) {
  const auto table = samples();
  table->q *= 5.0;  // slow enough for a difference below pi, were it in radians
  table->q.topRows(2) *= 0.25;
  report(*table, 0.0, 360.0);
  const MatrixXd q = table->q;
  unwrap(*table, JointType::kContinuous);
  EXPECT_EQ(table->q, q);
}

}  // namespace inverse_dynamics_evaluation::turns_test
