// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/residual_noise.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <random>
#include <string>

#include "whitening.hpp"

namespace inverse_dynamics_identification::residual_noise_test {

using testing::HasSubstr;

/// White noise in the first row, noise that remembers for `memory` s in the second, both in the third.
Eigen::MatrixXd samples(const Eigen::VectorXd& time, double memory) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd all(3, time.size());
  double state = 0.0;
  for (Eigen::Index k = 0; k < time.size(); ++k) {
    const double kept = k == 0 ? 0.0 : std::exp(-(time[k] - time[k - 1]) / memory);
    state = kept * state + std::sqrt(1 - kept * kept) * normal(random);
    const double white = normal(random);
    all.col(k) << 2.0 * white, 0.5 * state, state + white;
  }
  return all;
}

TEST(ResidualNoise, TellsWhiteNoiseFromNoiseThatRemembers) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> period(0.02, 0.04);
  Eigen::VectorXd time(4000);
  double t = 5.0;
  for (double& sample : time) sample = t += period(random);
  const ResidualNoise noise = residualNoise(time, samples(time, 0.2));
  EXPECT_NEAR(noise.total(0), 2.0, 0.1);
  EXPECT_LT(noise.correlated[0], 0.2 * noise.white[0]);
  EXPECT_NEAR(noise.correlated[1], 0.5, 0.1);
  EXPECT_LT(noise.white[1], 0.1 * noise.correlated[1]);
  EXPECT_NEAR(noise.white[2] / noise.correlated[2], 1.0, 0.1);
}

TEST(ResidualNoise, NoiseThatForgetsWithinMillisecondsIsWhite) {
  // As accelerations leave it that are low-passed at 32 Hz, and efforts at 500 Hz.
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(10000, 0.0, 20.0);
  const ResidualNoise noise = residualNoise(time, samples(time, 0.005).row(1));
  EXPECT_LT(noise.correlated[0], 0.5 * noise.white[0]);
}

TEST(ResidualNoise, FilteredNoiseIsWhiteAndOfUnitVariance) {
  Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(20000, 0.0, 200.0);
  const Eigen::MatrixXd all = samples(time, 0.2);
  NoiseFilter filter(1.0, 1.0, 0.2);
  using Scalar = Eigen::Matrix<double, 1, 1>;
  Scalar state = Scalar::Zero();
  double squares = 0.0, neighbours = 0.0, last = 0.0;
  for (Eigen::Index k = 0; k < time.size(); ++k) {
    filter.advance(0.01);
    const double e = filter.innovations(Scalar(all(2, k)), state)[0];
    squares += e * e;
    neighbours += e * last;
    last = e;
  }
  EXPECT_NEAR(squares / 20000, 1.0, 0.03);
  EXPECT_NEAR(neighbours / 20000, 0.0, 0.03);
}

TEST(ResidualNoise, OfNothingIsWhatNoSensorReaches) {
  const ResidualNoise noise =
      residualNoise(Eigen::VectorXd::LinSpaced(10, 0.0, 1.0), Eigen::MatrixXd::Zero(2, 10));
  EXPECT_EQ(noise.white[0], 1e-6);
  EXPECT_EQ(noise.correlated[1], 0.0);
}

TEST(ResidualNoise, RefusesWhatIsNoSeries) {
  const auto error = [](const Eigen::VectorXd& time, const Eigen::MatrixXd& residuals,
                        double memory) -> std::string {
    try {
      residualNoise(time, residuals, memory);
    } catch (const inverse_dynamics_solver::InvalidParameterValueException& e) {
      return e.what();
    }
    return "none";
  };
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(10, 0.0, 1.0);
  Eigen::MatrixXd residuals = Eigen::MatrixXd::Ones(2, 10);
  EXPECT_EQ(error(time, residuals, 0.2), "none");
  EXPECT_THAT(error(time, residuals, 0.0), HasSubstr("correlation_time"));
  EXPECT_THAT(error(time.head(9), residuals, 0.2), HasSubstr("expected 9 samples, got 10"));
  EXPECT_THAT(error(time.head(1), residuals.leftCols(1), 0.2), HasSubstr("two samples"));
  residuals(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error(time, residuals, 0.2), HasSubstr("finite"));
}

}  // namespace inverse_dynamics_identification::residual_noise_test
