// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/reference_guard.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::reference_guard_test {

constexpr double kPeriod = 0.1;  // s
const std::vector<std::string> kNames = {"a", "b"};

ReferenceLimits limits() {
  return {vec({-1.0, -2.0}), vec({1.0, 2.0}), vec({0.5, 3.0}), vec({4.0, 4.0}), vec({2.0, 2.0})};
}

ReferenceGuard guard() { return {limits(), vec({1.0, 1.0}), kNames}; }

Reference moving() { return referenceOf(vec({0.2, 0.3}), vec({0.4, 0.0}), vec({0.1, 0.0})); }

TEST(ReferenceGuard, RestsWhereItStartsUntilTheFirstReference) {
  ReferenceGuard g = guard();
  g.start(vec({5.0, 0.1}));  // even where no reference may be
  const Reference& reference = g.again(kPeriod);
  EXPECT_EQ(reference.q, vec({5.0, 0.1}));
  EXPECT_EQ(reference.qd, vec({0.0, 0.0}));
  EXPECT_FALSE(g.stopped());
  EXPECT_FALSE(g.isMoving());
}

TEST(ReferenceGuard, SoundReferencesPassAsTheyAre) {
  ReferenceGuard g = guard();
  g.start(vec({0.0, 0.0}));
  const Reference desired = referenceOf(vec({0.2, 0.3}), vec({0.4, -2.0}), vec({-1.9, -3.9}));
  const Reference& followed = g.next(desired, kPeriod);
  EXPECT_EQ(followed.q, desired.q);
  EXPECT_EQ(followed.qd, desired.qd);
  EXPECT_EQ(followed.qdd, desired.qdd);
  EXPECT_TRUE(g.isMoving());
  EXPECT_FALSE(g.stopped());
}

TEST(ReferenceGuard, MotionsTimedWithinTheLimitsPass) {
  ReferenceGuard g = guard();
  g.start(vec({0.0, 0.0}));
  g.next(referenceOf(vec({0.0, 0.0}), vec({0.5, -3.0}) * 1.003, vec({4.0, 2.0}) * 1.003), kPeriod);
  EXPECT_FALSE(g.stopped());
}

struct Case {
  Reference desired;
  StopReason reason;
  Eigen::Index joint;
};

std::vector<Case> unsound() {
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  return {{referenceOf(vec({0.0, kNan}), zero, zero), StopReason::kNotFinite, 1},
          {referenceOf(zero, vec({kInfinity, 0.0}), zero), StopReason::kNotFinite, 0},
          {referenceOf(zero, zero, vec({0.0, kNan})), StopReason::kNotFinite, 1},
          {referenceOf(vec({1.1, 0.0}), zero, zero), StopReason::kPosition, 0},
          {referenceOf(vec({0.0, -2.1}), zero, zero), StopReason::kPosition, 1},
          {referenceOf(zero, vec({-0.6, 0.0}), zero), StopReason::kVelocity, 0},
          {referenceOf(zero, zero, vec({0.0, -4.1})), StopReason::kAcceleration, 1},
          {referenceOf(zero, vec({-0.1, 0.0}), vec({2.1, 0.0})), StopReason::kAcceleration, 0},
          {Reference(3), StopReason::kWrongSize, -1}};
}

TEST(ReferenceGuard, TheFirstUnsoundReferenceStopsForGood) {
  for (const Case& each : unsound()) {
    SCOPED_TRACE(text(each.reason));
    ReferenceGuard g = guard();
    g.start(vec({0.0, 0.0}));
    g.next(moving(), kPeriod);
    // from 0.4 rad/s with 1 rad/s^2: 0.4 s, 0.08 rad
    for (int k = 0; k < 3; ++k) {
      const Reference& stopping = g.next(k == 0 ? each.desired : moving(), kPeriod);
      EXPECT_NEAR(stopping.qd[0], 0.4 - 0.1 * (k + 1), kRounding);
      EXPECT_NEAR(stopping.qdd[0], -1.0, kRounding);
      EXPECT_EQ(g.reason(), each.reason);
      EXPECT_EQ(g.joint(), each.joint);
    }
    for (int k = 0; k < 5; ++k) g.next(moving(), kPeriod);
    const Reference& rest = g.next(moving(), kPeriod);
    EXPECT_NEAR(rest.q[0], 0.28, kRounding);
    EXPECT_EQ(rest.qd, vec({0.0, 0.0}));

    g.start(vec({0.28, 0.3}));
    EXPECT_FALSE(g.stopped());
    EXPECT_EQ(g.next(moving(), kPeriod).q, moving().q);
  }
}

TEST(ReferenceGuard, AStopKeepsItsFirstReason) {
  ReferenceGuard g = guard();
  g.start(vec({0.0, 0.0}));
  g.stop(StopReason::kStale);
  g.stop(StopReason::kNotFinite, 1);
  EXPECT_EQ(g.reason(), StopReason::kStale);
  EXPECT_EQ(g.joint(), -1);
}

TEST(ReferenceGuard, BadLimitsAreRefused) {
  EXPECT_EQ(thrownBy([] {
              ReferenceLimits wrong = limits();
              wrong.upper[1] = -3.0;
              ReferenceGuard(wrong, vec({1.0, 1.0}), kNames);
            }),
            "reference guard: upper minus lower position limit: joint b: wrong value: expected a "
            "number above zero, or infinity for no limit [rad], got -1; correct this number");
  EXPECT_EQ(thrownBy([] {
              ReferenceLimits wrong = limits();
              wrong.velocity.resize(1);
              ReferenceGuard(wrong, vec({1.0, 1.0}), kNames);
            }),
            "reference guard: velocity limit: wrong size: expected 2 numbers [rad/s], got 1; give "
            "one for each of the joints a, b");
  EXPECT_EQ(thrownBy([] {
              ReferenceLimits wrong = limits();
              wrong.lower[0] = kNan;
              ReferenceGuard(wrong, vec({1.0, 1.0}), kNames);
            }),
            "reference guard: lower position limit: joint a: wrong value: expected a number, or "
            "infinity for no limit [rad], got nan; correct this number");
}

}  // namespace inverse_dynamics_control::reference_guard_test
