// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "motion.hpp"

// test_core.py of inverse_dynamics_tools compares it with scipy.
namespace inverse_dynamics_evaluation::low_pass_test {

using ::testing::HasSubstr;

// What is left of a start-up transient in the middle of 40 periods of the cut-off.
constexpr double kSettled = 1e-9;

Eigen::MatrixXd sine(double frequency, double sampling_frequency, Eigen::Index count) {
  const Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(count, 0.0, static_cast<double>(count - 1));
  return (2.0 * kPi * frequency / sampling_frequency * k + 0.3).sin().matrix().transpose();
}

TEST(LowPass, ScalesASineByItsGainWithoutDelay) {
  for (const int order : {1, 2, 3, 5}) {
    for (const double frequency : {1.0, 5.0, 8.0, 20.0}) {
      const Eigen::MatrixXd x = sine(frequency, 100.0, 801);
      const Eigen::MatrixXd y = lowPass(x, 100.0, 5.0, order);
      const double gain = lowPassGain(frequency, 5.0, 100.0, order);
      const Eigen::Index margin = 200;
      const Eigen::MatrixXd error = (y - gain * x).middleCols(margin, 801 - 2 * margin);
      EXPECT_LT(error.cwiseAbs().maxCoeff(), kSettled) << order << ", " << frequency << " Hz";
    }
  }
}

TEST(LowPass, HalvesASineAtTheCutOff) {
  for (int order = 1; order <= 12; ++order) {
    EXPECT_DOUBLE_EQ(lowPassGain(7.0, 7.0, 50.0, order), 0.5);
  }
  EXPECT_EQ(lowPassGain(0.0, 7.0, 50.0), 1.0);
  EXPECT_EQ(lowPassGain(25.0, 7.0, 50.0), 0.0);
}

TEST(LowPass, ContinuesEndsByOneAndAHalfPeriodsOfTheCutOff) {
  EXPECT_EQ(defaultPadding(1000, 100.0, 2.0, 2), 75);
  EXPECT_EQ(defaultPadding(1000, 100.0, 40.0, 2), 9);  // at least 3 (order + 1)
  EXPECT_EQ(defaultPadding(50, 100.0, 2.0, 2), 49);    // at most what there is
}

TEST(LowPass, RefusesWhatItCannotFilter) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Ones(2, 20);
  EXPECT_THAT(errorOf<EvaluationError>([&] { lowPass(x, 100.0, 50.0); }),
              HasSubstr("low-pass: cut-off: expected above 0 and below half the sampling "
                        "frequency, 50 Hz, got 50 Hz"));
  EXPECT_THROW(lowPass(x, 100.0, 0.0), std::invalid_argument);
  EXPECT_THROW(lowPass(x, 100.0, std::numeric_limits<double>::quiet_NaN()), EvaluationError);
  EXPECT_THAT(errorOf<EvaluationError>([&] { lowPass(x, -1.0, 2.0); }),
              HasSubstr("sampling frequency: expected a positive"));
  EXPECT_THAT(errorOf<EvaluationError>([&] { lowPass(x, 100.0, 2.0, 0); }),
              HasSubstr("order: expected 1 to 12, got 0"));
  EXPECT_THAT(errorOf<EvaluationError>([&] { lowPass(x, 100.0, 2.0, 2, 20); }),
              HasSubstr("padding: expected fewer than 20 samples, got 20"));
  EXPECT_THAT(
      errorOf<EvaluationError>([&] { lowPass(x.leftCols(9), 100.0, 2.0); }),
      HasSubstr("samples: expected 10 samples or more of 1 joint or more, got 2 joints x 9"));
  Eigen::MatrixXd bad = x;
  bad(1, 17) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOf<EvaluationError>([&] { lowPass(bad, 100.0, 2.0); }),
              HasSubstr("got nan for joint 2 in sample 18"));
}

}  // namespace inverse_dynamics_evaluation::low_pass_test
