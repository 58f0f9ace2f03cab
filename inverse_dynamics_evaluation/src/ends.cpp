// SPDX-License-Identifier: Apache-2.0

#include "ends.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "pi.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr Index kCoefficients = 4;  // of a cubic

// Powers of the instants, in units of the fitted length; one row per instant.
Eigen::MatrixXd powers(const Eigen::ArrayXd& instants) {
  Eigen::MatrixXd result(instants.size(), kCoefficients);
  for (Index p = 0; p < kCoefficients; ++p) {
    result.col(p) = instants.pow(static_cast<double>(p)).matrix();
  }
  return result;
}

}  // namespace

Eigen::MatrixXd beyondEnd(const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index count) {
  const Index fit = samples.cols();
  const auto length = static_cast<double>(fit);
  const Eigen::ArrayXd inside = Eigen::ArrayXd::LinSpaced(fit, 0.0, (length - 1.0) / length);
  const Eigen::ArrayXd outside =
      Eigen::ArrayXd::LinSpaced(count, -1.0 / length, -static_cast<double>(count) / length);
  const Eigen::VectorXd weight = (kPi / 2.0 * inside).cos().square().square().matrix();
  const Eigen::MatrixXd weighted = weight.asDiagonal() * powers(inside);
  const Eigen::Matrix4d normal = weighted.transpose() * powers(inside);
  const Eigen::Matrix<double, kCoefficients, Eigen::Dynamic> coefficients =
      Eigen::LDLT<Eigen::Matrix4d>(normal).solve(weighted.transpose() * samples.transpose());
  return (powers(outside) * coefficients).transpose();
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
