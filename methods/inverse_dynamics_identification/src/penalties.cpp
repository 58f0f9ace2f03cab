// SPDX-License-Identifier: Apache-2.0
#include "penalties.hpp"

#include <Eigen/Cholesky>
#include <chain_dynamics/error.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using Eigen::Index;
using Vector10 = Eigen::Matrix<double, 10, 1>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::Matrix4d pseudoInertiaAt(const Eigen::VectorXd& x, Index link) {
  const Vector10 p = x.segment<10>(kParameters * link);
  return pseudoInertia(LinkParameters::fromVector(p));
}

double penalty(const OwnColumn& column, double x) {
  double sum = 0;
  if (column.is_positive) sum -= x > 0 ? std::log(x) : -kInfinity;
  if (std::isfinite(column.most)) sum -= x < column.most ? std::log(column.most - x) : -kInfinity;
  const double deviations = (x - column.center) / column.deviation;
  return sum + deviations * deviations;
}

double firstDerivative(const OwnColumn& column, double x) {
  return (column.is_positive ? -1 / x : 0.0) +
         (std::isfinite(column.most) ? 1 / (column.most - x) : 0.0) +
         2 * (x - column.center) / column.deviation / column.deviation;
}

double secondDerivative(const OwnColumn& column, double x) {
  const double below = column.most - x;
  return (column.is_positive ? 1 / (x * x) : 0.0) +
         (std::isfinite(column.most) ? 1 / (below * below) : 0.0) +
         2 / column.deviation / column.deviation;
}

double startOf(const OwnColumn& column) {
  if (!column.is_positive) return column.center < column.most ? column.center : column.most - 1;
  return std::isfinite(column.most) ? 0.5 * column.most : 1.0;
}

}  // namespace

Penalties::Penalties(const Prior& prior) : described_(prior.links), own_(prior.own) {
  for (const LinkParameters& link : described_) {
    const Eigen::LLT<Eigen::Matrix4d> factor(pseudoInertia(link));
    if (factor.info() != Eigen::Success || !link.toVector().allFinite()) {
      throw chain_dynamics::ModelError("prior", "link " + std::to_string(inverses_.size() + 1),
                                       "the parameters of a rigid body", "others",
                                       "pass them through linkPrior()");
    }
    inverses_.emplace_back(factor.solve(Eigen::Matrix4d::Identity()));
  }
}

Index Penalties::unknowns() const {
  return kParameters * links() + static_cast<Index>(own_.size());
}

Eigen::VectorXd Penalties::start() const {
  Eigen::VectorXd x(unknowns());
  Index at = 0;
  for (const LinkParameters& link : described_) {
    x.segment<10>(at) = link.toVector();
    at += kParameters;
  }
  for (const OwnColumn& column : own_) x[at++] = startOf(column);
  return x;
}

void Penalties::limit(Eigen::VectorXd& x) const {
  Index at = kParameters * links();
  for (const OwnColumn& column : own_) {
    if (!std::isfinite(penalty(column, x[at]))) x[at] = startOf(column);
    ++at;
  }
}

double Penalties::value(double strength, const Eigen::VectorXd& x) const {
  double sum = 0;
  for (Index i = 0; i < links(); ++i) {
    const Eigen::Matrix4d P = pseudoInertiaAt(x, i);
    const double log_determinant = logDeterminant(P);
    if (!std::isfinite(log_determinant)) return kInfinity;
    sum += strength * ((inverses_[static_cast<std::size_t>(i)] * P).trace() - log_determinant);
  }
  Index at = kParameters * links();
  for (const OwnColumn& column : own_) sum += penalty(column, x[at++]);
  return std::isnan(sum) ? kInfinity : sum;
}

void Penalties::addDerivatives(double strength, const Eigen::VectorXd& x, Eigen::VectorXd& gradient,
                               Eigen::MatrixXd& hessian) const {
  for (Index i = 0; i < links(); ++i) {
    const Eigen::Matrix4d inverse = pseudoInertiaAt(x, i).llt().solve(Eigen::Matrix4d::Identity());
    const Index at = kParameters * i;
    gradient.segment<10>(at) +=
        strength * parameterGradient(inverses_[static_cast<std::size_t>(i)] - inverse);
    hessian.block<10, 10>(at, at) += strength * logDeterminantHessian(inverse);
  }
  Index at = kParameters * links();
  for (const OwnColumn& column : own_) {
    gradient[at] += firstDerivative(column, x[at]);
    hessian(at, at) += secondDerivative(column, x[at]);
    ++at;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
