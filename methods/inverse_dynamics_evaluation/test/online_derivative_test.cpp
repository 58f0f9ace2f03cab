// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/online_derivative.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation::online_derivative_test {

using ::testing::HasSubstr;
using Step = OnlineDerivative::Step;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-9;  // stamps are whole nanoseconds

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }
std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

TEST(OnlineDerivative, OfARampIsItsSlopeAfterTheExactStart) {
  constexpr double kCutoff = 5.0;
  const double w = 2 * kPi * kCutoff;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> distance(1e-4, 0.1);  // samples at any distances
  OnlineDerivative filter(1, kCutoff);
  for (double t = 0; t < 2; t += distance(random)) {
    t = 1e-9 * static_cast<double>(nanoseconds(t));
    filter.update(nanoseconds(t), one(3 * t));
    const double begun = 1 - (1 + w * t) * std::exp(-w * t);  // step response of the low-pass
    EXPECT_NEAR(filter.derivative()[0], 3 * begun, 3 * kRounding * w) << t;
  }
  EXPECT_NEAR(filter.derivative()[0], 3, 1e-6);
}

TEST(OnlineDerivative, HasHalfTheGainOfADerivativeAtTheCutOff) {
  constexpr double kCutoff = 2.0;
  const double w = 2 * kPi * kCutoff;
  OnlineDerivative filter(1, kCutoff);
  double greatest = 0;
  for (int k = 0; k < 10000; ++k) {
    const double t = 1e-3 * k;
    filter.update(nanoseconds(t), one(std::sin(w * t)));
    greatest = std::max(greatest, t > 5 ? std::abs(filter.derivative()[0]) : 0);
  }
  EXPECT_NEAR(greatest, 0.5 * w, 1e-4 * w);
}

TEST(OnlineDerivative, AndItsValueLagSlowMotionByTheDelay) {
  OnlineDerivative filter(1, 10.0);
  const double w = 2 * kPi * 0.1;
  double t = 0;
  for (int k = 0; k < 20000; ++k) {
    t = 1e-3 * k;
    filter.update(nanoseconds(t), one(std::sin(w * t)));
  }
  EXPECT_DOUBLE_EQ(filter.delay(), 1 / (kPi * 10.0));
  EXPECT_NEAR(filter.derivative()[0], w * std::cos(w * (t - filter.delay())), 1e-3 * w);
  EXPECT_NEAR(filter.value()[0], std::sin(w * (t - filter.delay())), 1e-3);
}

TEST(OnlineDerivative, IsSettledWhenTheStartHasDiedAway) {
  OnlineDerivative filter(1, 5.0);
  EXPECT_FALSE(filter.settled());
  double settled_at = -1;
  for (int k = 0; settled_at < 0; ++k) {
    filter.update(nanoseconds(1e-3 * k), one(1e-3 * k));
    settled_at = filter.settled() ? 1e-3 * k : -1;
  }
  EXPECT_NEAR(settled_at, 1.0566 / 5.0, 1e-3);
  EXPECT_NEAR(filter.derivative()[0], 0.99, 1e-3);
}

TEST(OnlineDerivative, StartsAnewWhenTheClockJumpsBackOrAfterAGap) {
  OnlineDerivative filter(1, 5.0, 0.5);
  const auto run = [&](double begin) {
    Step first = Step::kRepeated;
    for (int k = 0; k < 1000; ++k) {
      const Step step = filter.update(nanoseconds(begin + 1e-3 * k), one(k));
      if (k == 0) {
        first = step;
        EXPECT_EQ(filter.derivative()[0], 0);
        EXPECT_FALSE(filter.settled());
      } else {
        EXPECT_EQ(step, Step::kContinued);
      }
    }
    EXPECT_TRUE(filter.settled());
    return first;
  };
  EXPECT_EQ(run(100), Step::kStarted);
  EXPECT_EQ(run(50), Step::kWentBack);
  EXPECT_EQ(run(60), Step::kGap);
  filter.reset();
  EXPECT_EQ(run(61), Step::kStarted);
}

TEST(OnlineDerivative, LeavesASampleWithTheSameStampOut) {
  OnlineDerivative filter(1, 5.0);
  filter.update(0, one(0));
  filter.update(1'000'000, one(1));
  const double before = filter.derivative()[0];
  EXPECT_EQ(filter.update(1'000'000, one(100)), Step::kRepeated);
  EXPECT_EQ(filter.derivative()[0], before);
}

TEST(OnlineDerivative, RefusesACutOffThatIsNone) {
  EXPECT_THAT(errorOf<EvaluationError>([] { OnlineDerivative(1, 0.0); }),
              HasSubstr("cut-off [Hz]: expected a number above 0"));
  EXPECT_THAT(errorOf<EvaluationError>([] { OnlineDerivative(1, 5.0, -1.0); }),
              HasSubstr("longest gap [s]: expected a number"));
}

}  // namespace inverse_dynamics_evaluation::online_derivative_test
