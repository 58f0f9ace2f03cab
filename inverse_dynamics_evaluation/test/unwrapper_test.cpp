// SPDX-License-Identifier: Apache-2.0

#include "unwrapper.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace inverse_dynamics_evaluation::unwrapper_test {

using chain_dynamics::JointType;
using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kTurn = 6.283185307179586;
constexpr double kPeriod = 0.02;     // s
constexpr double kRounding = 1e-12;  // of a dozen turns
constexpr Index kBlocks = 4, kSize = 50;

// Three joints turn at 20, -20 and 0.5 rad/s from q0 on.
SampleBlock samples(Index block, double q0 = 1.0) {
  SampleBlock next;
  next.first = block * kSize;
  next.time = kPeriod * Eigen::VectorXd::LinSpaced(kSize, static_cast<double>(next.first),
                                                   static_cast<double>(next.first + kSize - 1));
  next.qd = Eigen::Vector3d(20.0, -20.0, 0.5).replicate(1, kSize);
  next.q = next.qd * next.time.asDiagonal() + MatrixXd::Constant(3, kSize, q0);
  return next;
}

void report(SampleBlock& block, double low, double turn = kTurn) {
  block.q = block.q.unaryExpr([=](double q) { return q - turn * std::floor((q - low) / turn); });
}

TEST(Unwrapper, PositionsWithinATurnGoOnAsUnboundedOnes) {
  for (const double low : {-0.5 * kTurn, 0.0}) {
    Unwrapper unwrapper(std::vector<JointType>(3, JointType::kContinuous));
    for (int pass = 0; pass < 2; ++pass, unwrapper.rewind()) {
      for (Index b = 0; b < kBlocks; ++b) {
        SampleBlock block = samples(b);
        report(block, low);
        unwrapper.unwrap(block);
        EXPECT_LT((block.q - samples(b).q).cwiseAbs().maxCoeff(), kRounding);
      }
      EXPECT_TRUE(unwrapper.findings({"a", "b", "c"}).empty());
    }
  }
}

TEST(Unwrapper, UnboundedPositionsStayBitForBit) {
  Unwrapper unwrapper(std::vector<JointType>(3, JointType::kContinuous));
  for (Index b = 0; b < kBlocks; ++b) {
    SampleBlock block = samples(b, 30.0);
    unwrapper.unwrap(block);
    EXPECT_EQ(block.q, samples(b, 30.0).q);
  }
}

TEST(Unwrapper, ARevoluteJointKeepsItsPositionsAndItsJumpsAreNoted) {
  Unwrapper unwrapper({JointType::kRevolute, JointType::kPrismatic, JointType::kRevolute});
  Index jumps = 0, first = 0;
  double before = 1.0;
  for (Index b = 0; b < kBlocks; ++b) {
    SampleBlock block = samples(b);
    report(block, -0.5 * kTurn);
    const MatrixXd q = block.q;
    for (Index k = 0; k < kSize; ++k) {
      if (q(0, k) < before && jumps++ == 0) first = block.first + k + 1;
      before = q(0, k);
    }
    unwrapper.unwrap(block);
    EXPECT_EQ(block.q, q);
  }
  EXPECT_THAT(unwrapper.findings({"a", "b", "c"}),
              ElementsAre(HasSubstr("positions of a jump by a whole turn " + std::to_string(jumps) +
                                    " times, first in sample " + std::to_string(first))));
}

TEST(Unwrapper, ALongJumpThatVelocitiesExplainIsNoWholeTurn) {
  Unwrapper unwrapper(std::vector<JointType>(3, JointType::kRevolute));
  SampleBlock block = samples(0);
  block.time *= 0.35 / kPeriod;  // so few samples that a joint really moves by 7 rad in between
  block.q = block.qd * block.time.asDiagonal();
  unwrapper.unwrap(block);
  EXPECT_TRUE(unwrapper.findings({"a", "b", "c"}).empty());
}

TEST(Unwrapper, PositionsThatVelocityConfirmStay) {
  Unwrapper unwrapper(std::vector<JointType>(3, JointType::kContinuous));
  SampleBlock block = samples(0);
  const double degrees = 57.29577951308232 / 4.0;  // 5.7 from sample to sample
  block.q *= degrees, block.qd *= degrees;
  const MatrixXd q = block.q;
  unwrapper.unwrap(block);
  EXPECT_EQ(block.q, q);
}

TEST(Unwrapper, PositionsInDegreesStay) {
  Unwrapper unwrapper(std::vector<JointType>(3, JointType::kContinuous));
  SampleBlock block = samples(0);
  block.q *= 5.0;  // slow enough for a difference below pi, were it in radians
  block.q.row(0) *= 0.25, block.q.row(1) *= 0.25;
  report(block, 0.0, 360.0);
  const MatrixXd q = block.q;
  unwrapper.unwrap(block);
  EXPECT_EQ(block.q, q);
}

}  // namespace inverse_dynamics_evaluation::unwrapper_test
