// SPDX-License-Identifier: Apache-2.0

#include "ends.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr double kPi = 3.14159265358979323846;
constexpr Index kLeastFit = 6;
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

Eigen::MatrixXd continued(const Eigen::Ref<const Eigen::MatrixXd>& samples, Eigen::Index fit,
                          Eigen::Index count) {
  const Index total = samples.cols();
  fit = std::min(std::max(fit, kLeastFit), total);
  const auto length = static_cast<double>(fit);
  const Eigen::ArrayXd inside = Eigen::ArrayXd::LinSpaced(fit, 0.0, (length - 1.0) / length);
  const Eigen::ArrayXd outside =
      Eigen::ArrayXd::LinSpaced(count, -1.0 / length, -static_cast<double>(count) / length);
  const Eigen::VectorXd weight = (kPi / 2.0 * inside).cos().square().square().matrix();
  const Eigen::MatrixXd weighted = weight.asDiagonal() * powers(inside);
  const Eigen::Matrix4d normal = weighted.transpose() * powers(inside);
  const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
  const Eigen::MatrixXd beyond = powers(outside);

  // the end, with time counted backwards, is a beginning
  const auto cubic = [&](const Eigen::MatrixXd& first) -> Eigen::MatrixXd {
    const Eigen::Matrix<double, kCoefficients, Eigen::Dynamic> coefficients =
        solver.solve(weighted.transpose() * first.transpose());
    return (beyond * coefficients).transpose();
  };
  Eigen::MatrixXd result(samples.rows(), total + 2 * count);
  result.leftCols(count) = cubic(samples.leftCols(fit)).rowwise().reverse();
  result.middleCols(count, total) = samples;
  result.rightCols(count) = cubic(samples.rightCols(fit).rowwise().reverse());
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
