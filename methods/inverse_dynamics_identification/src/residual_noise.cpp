// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/residual_noise.hpp"

#include <array>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <string>

#include "whitening.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using Index = Eigen::Index;
using Scalar = Eigen::Matrix<double, 1, 1>;

constexpr double kLeast = 1e-6;  // N m: what no sensor reaches
constexpr std::array<double, 8> kShares = {0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0};

/// Twice the negative logarithm of the likelihood, of the best variance for this ratio of white to
/// correlated variance.
double misfit(const Eigen::Ref<const Eigen::VectorXd>& time,
              const Eigen::Ref<const Eigen::RowVectorXd>& residual, double ratio,
              double correlation_time) {
  NoiseFilter filter(ratio, 1.0, correlation_time);
  Scalar state = Scalar::Zero();
  double squares = 0.0, logarithms = 0.0, last = 0.0;
  for (Index k = 0; k < time.size(); ++k) {
    filter.advance(time[k] - last);
    squares += filter.innovations(Scalar(residual[k]), state).squaredNorm();
    logarithms += std::log(filter.variance());
    last = time[k];
  }
  const auto samples = static_cast<double>(time.size());
  return samples * std::log(squares / samples + std::numeric_limits<double>::min()) + logarithms;
}

/// Replaces samples by the means that the filter gets.
void takeMeans(Eigen::VectorXd& time, Eigen::MatrixXd& residuals, double correlation_time) {
  MeanSpan span(correlation_time);
  Index means = 0;
  double last = 0.0;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(residuals.rows());
  const auto end = [&] {
    time[means] = span.time();
    residuals.col(means++) = sum * span.weight();
    sum.setZero();
    span.restart();
  };
  for (Index k = 0; k < time.size(); ++k) {
    if (k > 0 && !(time[k] > last)) continue;
    last = time[k];
    if (span.endsBefore(last)) end();
    span.add(last);
    sum += residuals.col(k);
  }
  end();
  time.conservativeResize(means);
  residuals.conservativeResize(Eigen::NoChange, means);
}

void requireArgument(bool fine, const std::string& argument, const std::string& expected,
                     const std::string& got) {
  if (fine) return;
  throw inverse_dynamics_solver::InvalidParameterValueException("residualNoise: " + argument, "",
                                                                expected, got);
}

}  // namespace

double ResidualNoise::total(Index j) const { return std::hypot(white[j], correlated[j]); }

ResidualNoise residualNoise(const Eigen::Ref<const Eigen::VectorXd>& time,
                            const Eigen::Ref<const Eigen::MatrixXd>& residuals,
                            double correlation_time) {
  requireArgument(time.size() >= 2, "time", "two samples or more", std::to_string(time.size()));
  requireArgument(residuals.cols() == time.size(), "residuals",
                  std::to_string(time.size()) + " samples", std::to_string(residuals.cols()));
  requireArgument(time.allFinite() && residuals.allFinite(), "residuals", "finite numbers",
                  "a NaN or infinity");
  requireArgument(correlation_time > 0 && std::isfinite(correlation_time), "correlation_time",
                  "a finite number above zero [s]", std::to_string(correlation_time));
  Eigen::VectorXd at = time;
  Eigen::MatrixXd means = residuals;
  takeMeans(at, means, correlation_time);
  ResidualNoise noise;
  noise.correlation_time = correlation_time;
  noise.white.setZero(residuals.rows());
  noise.correlated.setZero(residuals.rows());
  for (Index j = 0; j < residuals.rows(); ++j) {
    const Eigen::RowVectorXd residual = means.row(j);
    const double total = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
    if (!(total > kLeast)) {
      noise.white[j] = kLeast;
      continue;
    }
    double best = std::numeric_limits<double>::infinity(), chosen = 0.0;
    for (const double ratio : kShares) {
      const double found = misfit(at, residual, ratio, correlation_time);
      if (found < best) {
        best = found;
        chosen = ratio;
      }
    }
    noise.correlated[j] = total / std::sqrt(1.0 + chosen);
    noise.white[j] = noise.correlated[j] * std::sqrt(chosen);
  }
  return noise;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
