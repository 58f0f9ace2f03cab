// SPDX-License-Identifier: Apache-2.0
#include "payload_solution.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <limits>

#include "inverse_dynamics_identification/pseudo_inertia.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

constexpr int kMostNewtonSteps = 100;
constexpr double kSmallDecrement = 1e-18;  // of Newton's decrement, squared
constexpr double kLeastStep = 1e-12;
constexpr double kNothing = 1e-13;  // information by the trace: rounding
constexpr double kLeastInformation = 1e-100;
constexpr double kDecrease = 1e-4;  // share of the promised decrease that a step must reach

Eigen::Matrix4d pseudoInertiaOf(const Vector10& phi) {
  return pseudoInertia(LinkParameters::fromVector(phi));
}

double valueOf(const Normal& normal, const Vector10& phi) {
  return 0.5 * phi.dot(normal.A * phi) - normal.b.dot(phi);
}

}  // namespace

BodyPrior::BodyPrior(double mass, const Eigen::Vector3d& center, double extent)
    : body_(LinkParameters::fromCenterOfMass(
                mass, center, 2.0 * mass * extent * extent * Eigen::Matrix3d::Identity())
                .toVector()),
      inverse_(pseudoInertiaOf(body_).inverse()) {}

double BodyPrior::value(const Vector10& phi) const {
  const Eigen::Matrix4d P = pseudoInertiaOf(phi);
  return inverse_.cwiseProduct(P).sum() - logDeterminant(P);
}

Vector10 BodyPrior::gradient(const Vector10& phi) const {
  return parameterGradient(inverse_ - pseudoInertiaOf(phi).inverse());
}

Matrix10 BodyPrior::hessian(const Vector10& phi) const {
  return logDeterminantHessian(pseudoInertiaOf(phi).inverse());
}

Matrix10 BodyPrior::inertiaInformation(const Vector10& phi) const {
  const Matrix10 H = hessian(phi);
  const Eigen::Matrix4d known = H.topLeftCorner<4, 4>();
  const Eigen::Matrix<double, 4, 6> coupling = H.topRightCorner<4, 6>();
  Matrix10 information = Matrix10::Zero();
  information.bottomRightCorner<6, 6>() =
      H.bottomRightCorner<6, 6>() - coupling.transpose() * known.ldlt().solve(coupling);
  return information;
}

Vector10 mostLikelyBody(const Normal& normal, const BodyPrior& prior) {
  Vector10 phi = prior.body();
  double value = valueOf(normal, phi) + prior.value(phi);
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    const Vector10 gradient = normal.A * phi - normal.b + prior.gradient(phi);
    const Matrix10 H = normal.A + prior.hessian(phi);
    const Vector10 direction = -H.ldlt().solve(gradient);
    const double decrement = -gradient.dot(direction);
    if (!(decrement > kSmallDecrement)) break;
    double share = 1.0, next = 0.0;
    for (; share > kLeastStep; share *= 0.5) {
      const Vector10 trial = phi + share * direction;
      next = valueOf(normal, trial) + prior.value(trial);
      if (next <= value - kDecrease * share * decrement) break;
    }
    if (!(share > kLeastStep)) break;  // rounding: no lower value is found
    phi += share * direction;
    value = next;
  }
  return phi;
}

Matrix10 leastInformation(const Matrix10& information) {
  // in units in which the numbers of a body are alike: kg, 0.1 kg m, 0.01 kg m^2
  Vector10 units;
  units << 1.0, 0.1, 0.1, 0.1, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01;
  const double trace = information.diagonal().dot(units.cwiseAbs2());
  const double least = std::max(kNothing * trace, kLeastInformation);
  return (least * units.cwiseAbs2().cwiseInverse()).asDiagonal();
}

Matrix10 covarianceOf(const Matrix10& information) {
  const Matrix10 bounded = information + leastInformation(information);
  const Vector10 units = bounded.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix10 scaled = units.asDiagonal() * bounded * units.asDiagonal();
  const Matrix10 inverse = scaled.ldlt().solve(Matrix10::Identity());
  const Matrix10 covariance = units.asDiagonal() * inverse * units.asDiagonal();
  return 0.5 * (covariance + covariance.transpose());
}

double studentT(double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::infinity();
  constexpr double kFew[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646};
  const double n = degrees_of_freedom;
  if (n < 7) {  // between whole numbers in 1 / n, to 1 %
    const auto k = static_cast<std::size_t>(n);
    const auto lower = static_cast<double>(k);
    const double share = (n - lower) * (lower + 1) / n;
    return kFew[k - 1] + share * (kFew[k] - kFew[k - 1]);
  }
  // Cornish and Fisher's expansion: to 1e-4 from 7 on
  const double z = 1.959964;
  const double z2 = z * z;
  return z + z * (z2 + 1) / (4 * n) + z * ((5 * z2 + 16) * z2 + 3) / (96 * n * n) +
         z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * n * n * n);
}

Eigen::Matrix3d centralInertiaChange(const Vector10& phi, const Vector10& d) {
  const Eigen::Vector3d h = phi.segment<3>(1), dh = d.segment<3>(1);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d dI;
  dI << d[4], d[5], d[6], d[5], d[7], d[8], d[6], d[8], d[9];
  // I_c = I - (h'h 1 - h h') / m
  return dI - (2.0 * h.dot(dh) * one - dh * h.transpose() - h * dh.transpose()) / phi[0] +
         (h.squaredNorm() * one - h * h.transpose()) * (d[0] / (phi[0] * phi[0]));
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
