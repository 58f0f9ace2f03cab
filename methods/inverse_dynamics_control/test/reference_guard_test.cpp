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

TEST(ReferenceGuard, FromAMotionItStopsUntilTheFirstReference) {
  ReferenceGuard g = guard();
  g.start(vec({0.1, 0.1}), vec({0.4, 0.0}));
  // from 0.4 rad/s with 1 rad/s^2: 0.4 s, 0.08 rad
  EXPECT_NEAR(g.again(kPeriod).qd[0], 0.3, kRounding);
  EXPECT_FALSE(g.isMoving());
  EXPECT_FALSE(g.stopped());
  EXPECT_EQ(g.next(moving(), kPeriod).q, moving().q);
  g.start(vec({0.1, 0.1}), vec({0.4, 0.0}));
  for (int k = 0; k < 5; ++k) g.again(kPeriod);
  EXPECT_NEAR(g.again(kPeriod).q[0], 0.18, kRounding);
  EXPECT_EQ(g.again(kPeriod).qd, vec({0.0, 0.0}));
}

TEST(ReferenceGuard, SoundReferencesPassAsTheyAre) {
  ReferenceGuard g = guard();
  g.start(vec({0.15, 0.0}));
  const Reference desired = referenceOf(vec({0.2, 0.3}), vec({0.4, -0.7}), vec({-1.9, -3.9}));
  const Reference& followed = g.next(desired, kPeriod);
  EXPECT_EQ(followed.q, desired.q);
  EXPECT_EQ(followed.qd, desired.qd);
  EXPECT_EQ(followed.qdd, desired.qdd);
  EXPECT_TRUE(g.isMoving());
  EXPECT_FALSE(g.stopped());
}

TEST(ReferenceGuard, MotionsTimedWithinTheLimitsPass) {
  ReferenceGuard g = guard();
  const Eigen::VectorXd q = vec({0.0, 0.0}), qd = vec({0.5, -3.0}) * 1.003;
  g.start(q);
  g.next(referenceOf(q, qd, vec({4.0, 2.0}) * 1.003), kPeriod, kPeriod, stateOf(q, qd));
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
    g.start(vec({0.15, 0.3}));
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

// After 0.1 s: twice 0.05 rad of joint a, twice 0.3 rad of joint b; twice 0.4 rad/s.
TEST(ReferenceGuard, AStepBeyondTheLimitsStopsForGood) {
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  const auto after = [&](const Reference& desired, double interval, const JointState& measured) {
    ReferenceGuard g = guard();
    g.start(zero);
    g.next(desired, kPeriod, interval, measured);
    return g.reason();
  };
  const auto at = [&](double q, double qd) {
    return referenceOf(vec({0.0, q}), vec({0.0, qd}), zero);
  };
  const JointState rest = stateOf(zero, zero), unknown = stateOf(vec({kNan, kNan}), zero);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(after(at(0.59 * sign, 0.0), kPeriod, rest), StopReason::kNone);
    EXPECT_EQ(after(at(0.61 * sign, 0.0), kPeriod, rest), StopReason::kStep);
    EXPECT_EQ(after(at(0.61 * sign, 0.0), 2 * kPeriod, rest), StopReason::kNone);
    EXPECT_EQ(after(at(0.0, 0.79 * sign), kPeriod, rest), StopReason::kNone);
    EXPECT_EQ(after(at(0.0, 0.81 * sign), kPeriod, rest), StopReason::kStep);
    // A reference may come nearer to the arm, as far as it is, and no farther.
    const JointState there = stateOf(vec({0.0, 1.0 * sign}), vec({0.0, 2.0 * sign}));
    EXPECT_EQ(after(at(1.5 * sign, 2.5 * sign), kPeriod, there), StopReason::kNone);
    EXPECT_EQ(after(at(1.7 * sign, 0.0), kPeriod, there), StopReason::kStep);
    EXPECT_EQ(after(at(-0.7 * sign, 0.0), kPeriod, there), StopReason::kStep);
    EXPECT_EQ(after(at(0.61 * sign, 0.0), kPeriod, unknown), StopReason::kStep);
  }
}

TEST(ReferenceGuard, AStepIsRampedOnRequest) {
  constexpr double kShort = 1e-3;  // s
  ReferenceGuard g(limits(), vec({1.0, 2.0}), kNames, {}, Steps::kRamp);
  const Eigen::VectorXd zero = vec({0.0, 0.0}), there = vec({0.9, -1.5});
  g.start(zero);
  const Reference desired = referenceOf(there, zero, zero);
  Eigen::VectorXd q = zero, qd = zero;
  int cycles = 0;
  do {
    const Reference& next = g.next(desired, kShort);
    EXPECT_LE((next.q - q).cwiseAbs()[0], 0.5 * kShort + kRounding);
    EXPECT_LE((next.qd - qd).cwiseAbs()[0], 1.0 * kShort + kRounding);
    EXPECT_LE((next.qd - qd).cwiseAbs()[1], 2.0 * kShort + kRounding);
    q = next.q, qd = next.qd;
  } while (g.ramping() && ++cycles < 10000);
  // 0.9 rad at up to 0.5 rad/s, 1 rad/s^2
  EXPECT_NEAR(cycles * kShort, 0.9 / 0.5 + 0.5 / 1.0, 0.02);
  EXPECT_EQ(q, there);
  EXPECT_FALSE(g.isMoving());
  EXPECT_FALSE(g.stopped());
}

TEST(ReferenceGuard, ARampEndsInAMotion) {
  constexpr double kShort = 1e-3;  // s
  ReferenceGuard g(limits(), vec({1.0, 2.0}), kNames, {}, Steps::kRamp);
  g.start(vec({0.0, 0.0}));
  Reference desired = referenceOf(vec({-0.8, 0.0}), vec({0.2, 0.0}), vec({0.0, 0.0}));
  g.next(desired, kShort);
  for (int k = 0; k < 8000 && g.ramping(); ++k) {
    desired.q += desired.qd * kShort;
    g.next(desired, kShort);
  }
  EXPECT_FALSE(g.ramping());
  EXPECT_EQ(g.again(kShort).q, desired.q);
  desired.q[0] = kNan;
  g.next(desired, kShort);
  EXPECT_EQ(g.reason(), StopReason::kNotFinite);
}

TEST(ReferenceGuard, AFaultEndsARamp) {
  ReferenceGuard g(limits(), vec({1.0, 1.0}), kNames, {}, Steps::kRamp);
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  g.start(zero);
  g.next(referenceOf(vec({0.9, 0.0}), zero, zero), kPeriod);
  EXPECT_TRUE(g.ramping());
  g.next(referenceOf(vec({0.9, kNan}), zero, zero), kPeriod);
  EXPECT_EQ(g.reason(), StopReason::kNotFinite);
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
