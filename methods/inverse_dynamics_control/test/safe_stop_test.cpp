// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/safe_stop.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::safe_stop_test {

const std::vector<std::string> kNames = {"a", "b"};

TEST(SafeStop, JointsStopTogetherWithinTheirDecelerations) {
  SafeStop stop(vec({4.0, 2.0}), kNames);
  ASSERT_EQ(stop.begin(vec({1.0, 2.0}), vec({2.0, -2.0})), Status::kOk);
  EXPECT_DOUBLE_EQ(stop.duration(), 1.0);  // the second joint takes longest
  Reference reference(2);
  EXPECT_EQ(stop.advance(0.5, reference), Status::kOk);
  EXPECT_FALSE(stop.finished());
  EXPECT_LT((reference.q - vec({1.75, 1.25})).norm(), kRounding);
  EXPECT_LT((reference.qd - vec({1.0, -1.0})).norm(), kRounding);
  EXPECT_LT((reference.qdd - vec({-2.0, 2.0})).norm(), kRounding);
  EXPECT_EQ(stop.advance(0.7, reference), Status::kOk);
  EXPECT_TRUE(stop.finished());
  EXPECT_LT((reference.q - vec({2.0, 1.0})).norm(), kRounding);
  EXPECT_EQ(reference.qd, vec({0.0, 0.0}));
  EXPECT_EQ(reference.qdd, vec({0.0, 0.0}));
}

TEST(SafeStop, AClockThatJumpsBackStandsStill) {
  SafeStop stop(vec({4.0, 2.0}), kNames);
  ASSERT_EQ(stop.begin(vec({1.0, 2.0}), vec({2.0, -2.0})), Status::kOk);
  Reference reference(2);
  for (const double period : {0.0, -1.0, kNan}) {
    EXPECT_EQ(stop.advance(period, reference), Status::kOk);
    EXPECT_EQ(reference.qd, vec({2.0, -2.0}));
  }
}

TEST(SafeStop, AtRestItIsFinishedAtOnce) {
  SafeStop stop(vec({4.0, 2.0}), kNames);
  ASSERT_EQ(stop.begin(vec({1.0, 2.0}), vec({0.0, 0.0})), Status::kOk);
  EXPECT_TRUE(stop.finished());
  Reference reference(2);
  EXPECT_EQ(stop.advance(1e-3, reference), Status::kOk);
  EXPECT_EQ(reference.q, vec({1.0, 2.0}));
  EXPECT_EQ(reference.qd, vec({0.0, 0.0}));
}

TEST(SafeStop, MotionsThatAreNoneAreRefused) {
  SafeStop stop(vec({4.0, 2.0}), kNames);
  Reference reference(2), other(3);
  reference.q.setConstant(7.0);
  EXPECT_EQ(stop.advance(1e-3, reference), Status::kReferenceNotFinite);
  EXPECT_EQ(reference.q, vec({7.0, 7.0}));
  EXPECT_FALSE(stop.finished());
  EXPECT_EQ(stop.begin(vec({1.0, kNan}), vec({0.0, 0.0})), Status::kReferenceNotFinite);
  EXPECT_EQ(stop.begin(vec({1.0, 2.0}), vec({kInfinity, 0.0})), Status::kReferenceNotFinite);
  EXPECT_EQ(stop.begin(vec({1.0}), vec({0.0})), Status::kWrongSize);
  EXPECT_EQ(stop.advance(1e-3, other), Status::kWrongSize);
}

TEST(SafeStop, BadDecelerationsAreRefused) {
  EXPECT_EQ(thrownBy([] {
              SafeStop(vec({1.0, 0.0}), kNames);
            }),
            "safe stop: deceleration: joint b: wrong value: expected a finite number above zero "
            "[rad/s^2], got 0; correct this number");
}

}  // namespace inverse_dynamics_control::safe_stop_test
