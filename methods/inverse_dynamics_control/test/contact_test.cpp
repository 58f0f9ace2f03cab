// SPDX-License-Identifier: Apache-2.0
//
// Thresholds for a stated number of false alarms, and the detector that uses them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

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
/// Exponential tails; after the filter they are between a Gaussian's and these.
double laplace(std::mt19937& random) {
  return std::exponential_distribution<double>(3.0)(random) * (random() % 2 == 0 ? 1.0 : -1.0);
}
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

TEST(ContactThresholds, FalseAlarmsAreAtMostAsManyAsStated) {
  // From seconds as from a minute, for tails from a Gaussian's to an exponential one: no more than the
  // rate in the mean over recordings. 60 per hour, so that a quarter of an hour each is enough.
  const double stated = 60.0;
  for (const Noise::Draw& draw : {Noise::Draw(gaussian), Noise::Draw(laplace)}) {
    for (const Eigen::Index count : {3000, 60000}) {
      int together = 0;
      for (unsigned seed = 0; seed < 3; ++seed) {
        Noise noise(seed, draw);
        const auto thresholds = contactThresholds(noise.next(count), kPeriod, stated, kJoints);
        together += alarms(thresholds, noise, 0.25);
      }
      EXPECT_LE(together, 3 * stated * 0.25) << count;
    }
  }
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
    const double a = std::exp(-60.0 * kPeriod);
    EXPECT_NEAR(thresholds.noise[j], 0.3 * std::sqrt((1 - a) / (1 + a)), 0.003);
    EXPECT_GE(thresholds.peaks[j], 20.0);
    EXPECT_LE(thresholds.peaks[j], 130.0);
  }
  EXPECT_EQ(thresholds.false_alarms_per_hour, 1.0);
}

TEST(ContactThresholds, AFewPeaksMeanAHighThreshold) {
  double before = 100.0;
  for (const Eigen::Index count : {300, 3000, 60000}) {
    double mean = 0.0;
    for (unsigned seed = 0; seed < 10; ++seed) {
      Noise noise(seed, gaussian);
      const auto thresholds = contactThresholds(noise.next(count), kPeriod, 1.0, kJoints);
      mean += (thresholds.torques.array() / thresholds.noise.array()).mean() / 10.0;
      EXPECT_GE(thresholds.shape.minCoeff(), 1.0 / thresholds.peaks.maxCoeff());
    }
    EXPECT_LT(mean, before) << count;
    before = mean;
  }
  EXPECT_LT(before, 8.0);  // 5.0 is that of Gaussian noise whose distribution is known
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

TEST(ContactThresholds, EqualPeaksPredictByTheirNumber) {
  // Two levels: those above the level are all equal, in units in which that isn't exact.
  for (const double unit : {1.0, 0.1, 1.0 / 3.0, 0.7, 1e-3}) {
    const auto thresholds = contactThresholds(
        pulses({unit, unit, unit, unit, unit, unit, unit, unit, unit, 3.0 * unit}, 1000), kPeriod,
        1.0, kJoints);
    EXPECT_NEAR(thresholds.level[0], unit, 1e-9 * unit);
    EXPECT_EQ(thresholds.peaks[0], 100.0);
    EXPECT_NEAR(thresholds.shape[0], 0.01, 1e-12);
    EXPECT_NEAR(thresholds.scale[0], 2.0 * unit, 1e-9 * unit);
    // 100 peaks in 20 s, and 1 in 2 h of each joint: k m ((100 / 20 s * 7200 s)^(1/k) - 1)
    EXPECT_NEAR(thresholds.torques[0], unit * (1.0 + 2.0 * 100.0 * (std::pow(36000.0, 0.01) - 1.0)),
                1e-9 * unit);
  }
}

TEST(ContactThresholds, HeavyTailsHaveAShape) {
  // A generalised Pareto distribution of shape 0.4, one value in 20 ms, of which 100 are above.
  std::mt19937 random(1);
  std::vector<double> heights(1000);
  for (double& height : heights) {
    const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    height = 1.0 + (std::pow(1.0 - share, -0.4) - 1.0) / 0.4;
  }
  const auto thresholds = contactThresholds(pulses(heights, 1000), kPeriod, 1.0, kJoints);
  EXPECT_GT(thresholds.shape[0], 0.1);
  EXPECT_LT(thresholds.shape[0], 0.5);
}

TEST(ContactThresholds, WhatCannotBeLearnedFromIsRefused) {
  Noise noise(3, gaussian);
  const auto text = [](const Eigen::MatrixXd& quiet, double period, double rate) {
    return thrownBy([&] { contactThresholds(quiet, period, rate, kJoints); });
  };
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

TEST(ContactDetector, WhatIsNotANumberNeitherEndsNorHidesAContact) {
  ContactDetector detector(vec({1.0, 1.0}), {}, kJoints);
  for (int k = 0; k < 2000; ++k) {
    const double torque = k == 600 ? kNan : 5.0;
    EXPECT_TRUE(detector.update(vec({torque, 0.0}), kPeriod)) << k;
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
