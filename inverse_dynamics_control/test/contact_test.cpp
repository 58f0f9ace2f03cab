// SPDX-License-Identifier: Apache-2.0
//
// Thresholds for a stated number of false alarms, and the detector that uses them.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "arms.hpp"

namespace inverse_dynamics_control::contact_test {

constexpr double kPeriod = 1e-3;  // s
const std::vector<std::string> kJoints{"shoulder", "elbow"};

/// Noise of n joints as a first-order low-pass (60 1/s) gives it.
class Noise {
 public:
  using Draw = std::function<double(std::mt19937&)>;
  Noise(unsigned seed, Draw draw) : random_(seed), draw_(std::move(draw)) {}

  Eigen::VectorXd next() {
    for (double& x : state_) x += -std::expm1(-60.0 * kPeriod) * (draw_(random_) - x);
    return state_;
  }
  Eigen::MatrixXd next(Eigen::Index count) {
    Eigen::MatrixXd result(2, count);
    for (Eigen::Index k = 0; k < count; ++k) result.col(k) = next();
    return result;
  }

 private:
  std::mt19937 random_;
  Draw draw_;
  Eigen::VectorXd state_ = vec({0.0, 0.0});
};

double gaussian(std::mt19937& random) { return std::normal_distribution<double>(0, 0.3)(random); }
/// With tails that fall with the fourth power, after the filter still heavier than a Gaussian's.
double heavy(std::mt19937& random) { return std::student_t_distribution<double>(4.0)(random); }

/// Contacts that a detector begins within hours of noise.
int alarms(const ContactThresholds& thresholds, Noise& noise, double hours) {
  ContactDetector detector(thresholds.torques, {}, kJoints);
  int result = 0;
  bool before = false;
  for (double t = 0.0; t < hours * 3600.0; t += kPeriod) {
    const bool now = detector.update(noise.next(), kPeriod);
    result += now && !before ? 1 : 0;
    before = now;
  }
  return result;
}

TEST(ContactThresholds, FalseAlarmsAreAsManyAsStated) {
  // A minute is recorded, and the rate is asked for that one in two minutes belongs to: over 2 hours
  // 60 alarms. A tail that is learned from so few peaks is uncertain: a factor of three.
  const double stated = 30.0;
  int together = 0;
  for (unsigned seed = 0; seed < 3; ++seed) {
    Noise noise(seed, gaussian);
    const auto thresholds = contactThresholds(noise.next(60000), kPeriod, stated, kJoints);
    together += alarms(thresholds, noise, 1.0);
  }
  EXPECT_GE(together, 3 * stated / 10.0);
  EXPECT_LE(together, 3 * stated * 1.5);
}

TEST(ContactThresholds, OfHeavyTailsAMinuteDoesNotShowAll) {
  // Beyond what a minute shows the tail gets heavier. No statistics can know; docs/contact.md says so.
  const double stated = 30.0;
  int together = 0;
  for (unsigned seed = 0; seed < 2; ++seed) {
    Noise noise(seed, heavy);
    const Eigen::MatrixXd quiet = noise.next(60000);
    const auto thresholds = contactThresholds(quiet, kPeriod, stated, kJoints);
    EXPECT_GT((thresholds.torques.array() / thresholds.noise.array()).minCoeff(), 4.5);
    together += alarms(thresholds, noise, 0.5);
  }
  EXPECT_LE(together, stated * 5.0);
}

TEST(ContactThresholds, RarerAlarmsNeedHigherThresholds) {
  Noise noise(1, gaussian);
  const Eigen::MatrixXd quiet = noise.next(60000);
  double before = 0.0;
  for (const double stated : {100.0, 10.0, 1.0, 0.1, 0.01}) {
    const auto thresholds = contactThresholds(quiet, kPeriod, stated, kJoints);
    EXPECT_GT(thresholds.torques.minCoeff(), before);
    before = thresholds.torques.maxCoeff() * 0.9;  // of both joints, alike
    EXPECT_GT(thresholds.torques[0], quiet.row(0).cwiseAbs().maxCoeff() * 0.8);
  }
}

TEST(ContactThresholds, CorrelationTimeAndNoiseAreThoseOfTheFilter) {
  Noise noise(2, gaussian);
  const auto thresholds = contactThresholds(noise.next(200000), kPeriod, 1.0, kJoints);
  for (int j = 0; j < 2; ++j) {
    EXPECT_NEAR(thresholds.correlation_time[j], 1.0 / 60.0, 0.003);
    EXPECT_NEAR(thresholds.independent[j], 200.0 / (2.0 / 60.0), 1000.0);
    const double a = std::exp(-60.0 * kPeriod);
    EXPECT_NEAR(thresholds.noise[j], 0.3 * std::sqrt((1 - a) / (1 + a)), 0.003);
    EXPECT_GE(thresholds.peaks[j], 20.0);
    EXPECT_LE(thresholds.peaks[j], 120.0);
  }
  EXPECT_EQ(thresholds.false_alarms_per_hour, 1.0);
}

TEST(ContactThresholds, TwentySecondsMayBeEnough) {
  Noise noise(4, gaussian);
  const auto thresholds = contactThresholds(noise.next(20000), 2e-3, 1.0, kJoints);
  for (int j = 0; j < 2; ++j) {
    EXPECT_GE(thresholds.peaks[j], 60.0);
    EXPECT_LT(thresholds.torques[j], 10.0 * thresholds.noise[j]);
  }
  Noise shorter(5, gaussian);
  EXPECT_GE(contactThresholds(shorter.next(6000), kPeriod, 1.0, kJoints).peaks.minCoeff(), 20.0);
}

/// Pulses of these heights, one after the other, for ever; in between nothing. 20 ms each.
Eigen::MatrixXd pulses(const std::vector<double>& heights, int count) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2, Eigen::Index{count} * 20);
  for (int k = 0; k < count; ++k) {
    const auto pulse = static_cast<std::size_t>(k) % heights.size();
    result.col(Eigen::Index{k} * 20).setConstant(heights[pulse]);
  }
  return result;
}

TEST(ContactThresholds, EqualPeaksAreATailWithoutAShape) {
  // Two levels: those above the level are all equal, in units in which that isn't exact.
  for (const double unit : {1.0, 0.1, 1.0 / 3.0, 0.7, 1e-3}) {
    const auto thresholds = contactThresholds(
        pulses({unit, unit, unit, unit, unit, unit, unit, unit, unit, 3.0 * unit}, 1000), kPeriod,
        1.0, kJoints);
    EXPECT_NEAR(thresholds.level[0], unit, 1e-9 * unit);
    EXPECT_EQ(thresholds.shape[0], 0.0);
    EXPECT_NEAR(thresholds.scale[0], 2.0 * unit, 1e-9 * unit);
    EXPECT_LT(thresholds.low[0], thresholds.torques[0]);
    EXPECT_NEAR(thresholds.high[0], thresholds.torques[0], 1e-9 * unit);
  }
}

TEST(ContactThresholds, TheRangeHoldsTheThresholdOfALongRecording) {
  // Half an hour shows what a minute and six seconds are to tell. 90 %: of 40 ranges 31 at least.
  Noise noise(6, gaussian);
  const double rate = 30.0;
  const auto known = contactThresholds(noise.next(1800000), kPeriod, rate, kJoints);
  double width = 0.0;
  for (const Eigen::Index count : {60000, 6000}) {
    int inside = 0;
    double mean_width = 0.0;
    for (int k = 0; k < 20; ++k) {
      const auto thresholds = contactThresholds(noise.next(count), kPeriod, rate, kJoints);
      for (int j = 0; j < 2; ++j) {
        EXPECT_LE(thresholds.low[j], thresholds.torques[j]);
        EXPECT_GE(thresholds.high[j], thresholds.torques[j]);
        inside += known.torques[j] >= thresholds.low[j] && known.torques[j] <= thresholds.high[j];
        mean_width += (thresholds.high[j] - thresholds.low[j]) / known.torques[j] / 40.0;
      }
    }
    EXPECT_GE(inside, 31) << count;
    EXPECT_GT(mean_width, 1.5 * width) << count;  // less data, less certain
    width = mean_width;
  }
}

TEST(ContactThresholds, WhatCannotBeLearnedFromIsRefused) {
  Noise noise(3, gaussian);
  const auto text = [](const Eigen::MatrixXd& quiet, double period, double rate) {
    return thrownBy([&] { contactThresholds(quiet, period, rate, kJoints); });
  };
  EXPECT_NE(text(noise.next(2000), kPeriod, 1.0)
                .find("contact thresholds: joint shoulder: too few independent samples: expected "
                      "20 peaks at least, about "),
            std::string::npos);
  Eigen::MatrixXd quiet = noise.next(60000);
  EXPECT_EQ(text(quiet, kPeriod, 1.0), "");
  EXPECT_EQ(text(quiet, 0.0, 1.0),
            "contact thresholds: period: wrong value: expected a finite number above zero [s], got "
            "0; correct this number");
  EXPECT_EQ(text(quiet, kPeriod, kInfinity),
            "contact thresholds: false_alarms_per_hour: wrong value: expected a finite number "
            "above zero [1/h], got inf; correct this number");
  for (const double extreme : {4.9e-324, 1e-300, 9e-7}) {
    EXPECT_NE(
        text(quiet, kPeriod, extreme)
            .find("false_alarms_per_hour: wrong value: expected a number of at least 1e-06 (one "
                  "in a century) [1/h], got "),
        std::string::npos);
  }
  EXPECT_NE(
      text(quiet, kPeriod, 1e5).find("joint shoulder: too many false alarms: expected at most 1"),
      std::string::npos);
  EXPECT_EQ(text(quiet.topRows(1), kPeriod, 1.0),
            "contact thresholds: quiet: wrong size: expected 2 numbers [N m], got 1; give one for "
            "each of the joints shoulder, elbow");
  quiet(1, 5) = kNan;
  EXPECT_EQ(text(quiet, kPeriod, 1.0),
            "contact thresholds: joint elbow: wrong value: expected finite external torques, got "
            "NaN or infinity; leave out what an estimator gave without status kOk");
  quiet.row(1).setZero();
  EXPECT_EQ(text(quiet, kPeriod, 1.0),
            "contact thresholds: joint elbow: no noise: expected external torques that vary, got "
            "the same in all samples; make thresholds from estimates without a friction band, of a "
            "robot that is switched on");
}

TEST(ContactDetector, AContactBeginsAtOnceAndIsOverAfterAWhile) {
  ContactDetector detector(vec({2.0, 4.0}), {0.5, 0.01}, kJoints);
  EXPECT_EQ(detector.joint(), -1);
  EXPECT_FALSE(detector.update(vec({2.0, -4.0}), kPeriod));
  EXPECT_EQ(detector.excess(), 1.0);
  EXPECT_TRUE(detector.update(vec({1.0, -4.4}), kPeriod));
  EXPECT_EQ(detector.joint(), 1);
  EXPECT_NEAR(detector.excess(), 1.1, kRounding);
  // below its threshold, but not below the share of the greatest torque
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(detector.update(vec({0.0, -2.3}), kPeriod));
  // below it, with an interruption; the other joint has never been beyond its threshold
  for (int k = 0; k < 9; ++k) EXPECT_TRUE(detector.update(vec({1.9, 0.9}), kPeriod));
  EXPECT_TRUE(detector.update(vec({0.0, 2.3}), kPeriod));
  for (int k = 0; k < 9; ++k) EXPECT_TRUE(detector.update(vec({1.9, 0.9}), kPeriod));
  EXPECT_TRUE(detector.update(vec({1.9, 0.9}), -1.0));  // no time passes
  EXPECT_FALSE(detector.update(vec({1.9, 0.9}), 1.1 * kPeriod));
  EXPECT_FALSE(detector.update(vec({1.9, 0.0}), kPeriod));  // needs the threshold again
  EXPECT_TRUE(detector.update(vec({-2.1, 0.0}), kPeriod));
}

TEST(ContactDetector, WhatFrictionHoldsAfterAContactIsNone) {
  ContactDetector detector(vec({2.0, 4.0}), {}, kJoints);
  const auto last = [&](double torque, int samples) {
    bool contact = false;
    for (int k = 0; k < samples; ++k) contact = detector.update(vec({torque, 0.0}), kPeriod);
    return contact;
  };
  EXPECT_TRUE(last(9.0, 1000));
  EXPECT_TRUE(last(4.0, 99));  // more than the threshold, and less than half of the greatest
  EXPECT_FALSE(last(4.0, 2));
  EXPECT_FALSE(last(4.0, 10000));
  EXPECT_EQ(detector.excess(), 2.0);
  // the next one is on top of it, or against it
  EXPECT_FALSE(last(5.9, 1));
  EXPECT_TRUE(last(6.1, 1));
  EXPECT_FALSE(last(4.0, 200));
  EXPECT_TRUE(last(-2.1, 1));
  EXPECT_FALSE(last(0.0, 200));
  EXPECT_TRUE(last(9.0, 1));
  EXPECT_FALSE(last(4.0, 200));
  // what has fallen isn't held any longer
  EXPECT_FALSE(last(1.6, 1));
  EXPECT_FALSE(last(4.4, 1));  // 2.6 are held
  EXPECT_TRUE(last(4.7, 1));
  EXPECT_FALSE(last(1.2, 200));
  EXPECT_FALSE(last(2.1, 1));  // 1.2 are held
  EXPECT_FALSE(last(0.0, 1));
  EXPECT_TRUE(last(2.1, 1));
}

TEST(ContactDetector, WhatIsNotANumberIsAContact) {
  for (const Eigen::VectorXd& bad : {vec({0.0, kNan}), vec({kInfinity, 0.0}), vec({1.0})}) {
    ContactDetector detector(vec({kInfinity, 4.0}), {}, kJoints);
    EXPECT_FALSE(detector.update(vec({100.0, 1.0}), kPeriod));  // not looked at
    EXPECT_TRUE(detector.update(bad, kPeriod));
    detector.reset();
    EXPECT_FALSE(detector.contact());
  }
}

TEST(ContactDetector, BadOptionsAreRefused) {
  const auto text = [](const Eigen::VectorXd& thresholds, ReleaseOptions release) {
    return thrownBy([&] { ContactDetector(thresholds, release, kJoints); });
  };
  EXPECT_EQ(text(vec({1.0, 0.0}), {}),
            "contact detector: thresholds: joint elbow: wrong value: expected a number above zero, "
            "or infinity for no limit [N m], got 0; correct this number");
  EXPECT_NE(text(vec({1.0}), {}), "");
  EXPECT_NE(text(vec({1.0, 1.0}), {1.5, 0.1}).find("release: share: wrong value"),
            std::string::npos);
  EXPECT_NE(text(vec({1.0, 1.0}), {0.0, 0.1}), "");
  EXPECT_NE(text(vec({1.0, 1.0}), {0.5, -0.1}), "");
}

}  // namespace inverse_dynamics_control::contact_test
