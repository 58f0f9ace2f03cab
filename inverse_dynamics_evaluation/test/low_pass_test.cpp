// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <array>
#include <limits>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "motion.hpp"

namespace inverse_dynamics_evaluation::low_pass_test {

using ::testing::HasSubstr;

// Two filters of the same mathematics in different forms, 40 samples: some hundred roundings.
constexpr double kSameFilter = 1e-12;
// What is left of a start-up transient in the middle of 40 periods of the cut-off.
constexpr double kSettled = 1e-9;

Eigen::MatrixXd sine(double frequency, double sampling_frequency, Eigen::Index count) {
  const Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(count, 0.0, static_cast<double>(count - 1));
  return (2.0 * kPi * frequency / sampling_frequency * k + 0.3).sin().matrix().transpose();
}

struct ScipyCase {
  int order;
  double cutoff;  // Hz, at a sampling frequency of 100 Hz
  Eigen::Index padding;
  std::array<double, 12> expected;  // of joint 0, then of joint 1, at the samples below
};

// By scipy 1.17.1, numpy imported as np, signal from scipy:
//   k = np.arange(40)
//   x = np.stack([np.sin(0.3*k) + 0.2*np.cos(2.1*k + 0.5), 0.01*k**2 - np.cos(1.7*k)])
//   sos = signal.butter(order, cutoff, fs=100.0, output='sos')
//   signal.sosfiltfilt(sos, x, axis=1, padlen=padding, padtype='odd' if padding else None)
constexpr std::array<Eigen::Index, 6> kScipySamples = {0, 1, 7, 20, 33, 39};
const std::array<ScipyCase, 5> kScipyCases = {{
    {1,
     5.0,
     6,
     {0.11980374265109486, 0.23927285130426312, 0.46302406241673982, -0.14623357190709332,
      -0.25912463071866632, -0.53981184374063962, -1.0160370071023639, -0.65744315644101048,
      0.54655669399271378, 4.2143858837279113, 11.133406725585218, 15.843611868991623}},
    {2,
     2.0,
     9,
     {0.020717941590091334, 0.038915695581422917, 0.08255782408419228, 0.012650278195972968,
      -0.14818033609364017, -0.27763384255582385, -1.3230976088774151, -1.1060190172677551,
      0.36059928308904771, 4.9110583313775331, 11.008202152405071, 13.159729501316233}},
    {2,
     2.0,
     30,
     {0.21641710994518726, 0.21114634049889547, 0.15317662418798408, 0.022853213438512564,
      -0.28884931205369124, -0.62377405163178512, -1.2488608658677434, -1.0241394768172365,
      0.34986829459053753, 4.5065849400467934, 11.967683776887984, 16.352248256631295}},
    {3,
     12.0,
     0,
     {0.21908994082069327, 0.35326933669928523, 0.87109555833970853, -0.2786848882202051,
      -0.45602215599025453, -0.99739064586355974, -0.50088422439065661, -0.22251735018346097,
      0.48231210247798068, 4.0001463774513288, 11.000604631652745, 13.26752238420595}},
    {4,
     20.0,
     15,
     {0.17531894804493017, 0.31971325886390928, 0.85762682296152781, -0.27936310353878269,
      -0.45305209792659706, -0.61155258998875983, -0.99879417563399431, -0.0074412594800237486,
      0.51016455564948915, 4.0225310421895646, 10.870917501025691, 16.157405725664951}},
}};

TEST(LowPass, IsScipysForwardBackwardFilter) {
  Eigen::MatrixXd x(2, 40);
  for (Eigen::Index k = 0; k < 40; ++k) {
    const auto t = static_cast<double>(k);
    x(0, k) = std::sin(0.3 * t) + 0.2 * std::cos(2.1 * t + 0.5);
    x(1, k) = 0.01 * t * t - std::cos(1.7 * t);
  }
  for (const ScipyCase& scipy : kScipyCases) {
    const Eigen::MatrixXd y = lowPass(x, 100.0, scipy.cutoff, scipy.order, scipy.padding);
    for (std::size_t i = 0; i < scipy.expected.size(); ++i) {
      const auto joint = static_cast<Eigen::Index>(i / kScipySamples.size());
      const Eigen::Index sample = kScipySamples[i % kScipySamples.size()];
      EXPECT_NEAR(y(joint, sample), scipy.expected[i], kSameFilter)
          << "order " << scipy.order << ", joint " << joint << ", sample " << sample;
    }
  }
}

TEST(LowPass, PassesAConstantUnchanged) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Constant(1, 50, 3.5);
  for (int order = 1; order <= 12; ++order) {
    EXPECT_LT((lowPass(x, 10.0, 1.0, order) - x).cwiseAbs().maxCoeff(), 1e-9) << order;
  }
}

TEST(LowPass, PassesARampUnchanged) {
  const Eigen::MatrixXd x = Eigen::RowVectorXd::LinSpaced(1000, 0.0, 999.0);
  for (int order = 1; order <= 6; ++order) {
    // it starts in the steady state of a constant, so the ends need some periods of the cut-off, 10
    // samples each: 1.5 of them leave half a per cent of what the ramp climbs in one
    EXPECT_LT((lowPass(x, 10.0, 1.0, order) - x).cwiseAbs().maxCoeff(), 0.05) << order;
    EXPECT_LT((lowPass(x, 10.0, 1.0, order, 500) - x).cwiseAbs().maxCoeff(), 1e-9) << order;
  }
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

TEST(LowPass, AnswersAnImpulseSymmetrically) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 401);
  x(0, 200) = 1.0;
  const Eigen::MatrixXd y = lowPass(x, 100.0, 6.0, 3);
  EXPECT_LT((y - y.rowwise().reverse()).cwiseAbs().maxCoeff(), kSettled);
  Eigen::Index peak = 0;
  y.row(0).maxCoeff(&peak);
  EXPECT_EQ(peak, 200);
}

TEST(LowPass, LeavesTheShareOfWhiteNoiseBelowItsCutOff) {
  std::mt19937 generator(3);
  std::normal_distribution<double> noise;
  const Eigen::MatrixXd x =
      Eigen::MatrixXd::NullaryExpr(1, 200000, [&] { return noise(generator); });
  // variance = mean of the squared gain over all frequencies
  double expected = 0.0;
  for (int i = 0; i < 5000; ++i) {
    expected += std::pow(lowPassGain(0.5 * (i + 0.5) / 5000.0, 0.05, 1.0), 2) / 5000.0;
  }
  const double variance = lowPass(x, 1.0, 0.05).squaredNorm() / 200000.0;
  // some 200000 * 0.1 independent values: a standard deviation of 1 %, so five of them
  EXPECT_NEAR(variance / expected, 1.0, 0.05);
}

TEST(LowPass, TreatsEachJointByItself) {
  const Motion motion = sines(100.0, 2.0, {0.5, 1.5, 4.0});
  const Eigen::MatrixXd together = lowPass(motion.qd, 100.0, 3.0);
  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_EQ(together.row(j), lowPass(motion.qd.row(j), 100.0, 3.0)) << j;
  }
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
