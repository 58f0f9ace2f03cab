// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/pseudo_inertia.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/error.hpp>
#include <limits>
#include <sstream>

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

Eigen::Matrix3d secondMoments(const Eigen::Matrix3d& inertia) {
  return 0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia;
}

Eigen::Matrix4d assembled(double mass, const Eigen::Vector3d& first,
                          const Eigen::Matrix3d& second) {
  Eigen::Matrix4d P;
  P.topLeftCorner<3, 3>() = second;
  P.topRightCorner<3, 1>() = first;
  P.bottomLeftCorner<1, 3>() = first.transpose();
  P(3, 3) = mass;
  return P;
}

}  // namespace

Eigen::Matrix4d pseudoInertia(const LinkParameters& link) {
  return assembled(link.mass, link.first_moment, secondMoments(link.inertia));
}

LinkParameters fromPseudoInertia(const Eigen::Matrix4d& P) {
  const Eigen::Matrix3d second = P.topLeftCorner<3, 3>();
  LinkParameters link = LinkParameters::zero();
  link.mass = P(3, 3);
  link.first_moment = P.topRightCorner<3, 1>();
  link.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;  // Sigma = 1/2 tr(I) 1 - I
  return link;
}

Eigen::Matrix<double, 10, 1> parameterGradient(const Eigen::Matrix4d& M) {
  // dSigma/dIxx = diag(-1, 1, 1) / 2; an entry off the diagonal is there twice
  const double half = 0.5 * (M(0, 0) + M(1, 1) + M(2, 2));
  Eigen::Matrix<double, 10, 1> gradient;
  gradient << M(3, 3), 2 * M(0, 3), 2 * M(1, 3), 2 * M(2, 3), half - M(0, 0), -2 * M(0, 1),
      -2 * M(0, 2), half - M(1, 1), -2 * M(1, 2), half - M(2, 2);
  return gradient;
}

double logDeterminant(const Eigen::Matrix4d& P) {
  const Eigen::LLT<Eigen::Matrix4d> factor(P);
  const Eigen::Vector4d diagonal = factor.matrixLLT().diagonal();
  if (factor.info() != Eigen::Success || !(diagonal.minCoeff() > 0)) {
    return -std::numeric_limits<double>::infinity();
  }
  return 2 * diagonal.array().log().sum();
}

Eigen::Matrix<double, 10, 10> logDeterminantHessian(const Eigen::Matrix4d& inverse) {
  using Vector10 = Eigen::Matrix<double, 10, 1>;
  Eigen::Matrix<double, 10, 10> hessian;
  for (Eigen::Index k = 0; k < 10; ++k) {
    const Vector10 unit = Vector10::Unit(k);
    const Eigen::Matrix4d E = pseudoInertia(LinkParameters::fromVector(unit));
    hessian.col(k) = parameterGradient(inverse * E * inverse);
  }
  return hessian;
}

LinkPrior linkPrior(const LinkParameters& described, const LinkFloor& floor) {
  if (!described.toVector().allFinite()) {
    throw chain_dynamics::ModelError("linkPrior: expected finite numbers, got others");
  }
  std::ostringstream changes;
  double mass = described.mass;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  if (mass > 0) center = described.first_moment / mass;
  if (mass < floor.mass) {
    changes << "a mass of " << floor.mass << " kg instead of " << mass << " kg";
    mass = floor.mass;
  }
  const double least = mass * floor.radius * floor.radius;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      secondMoments(chain_dynamics::inertiaAboutCenter(described)));
  const Eigen::Vector3d moments = axes.eigenvalues().cwiseMax(least);
  if (moments != axes.eigenvalues()) {
    if (changes.tellp() > 0) changes << ", ";
    changes << "second moments of mass about its center of at least " << least
            << " kg m^2 instead of " << axes.eigenvalues()[0] << " kg m^2";
  }
  const Eigen::Matrix3d second =
      axes.eigenvectors() * moments.asDiagonal() * axes.eigenvectors().transpose();
  return {fromPseudoInertia(
              assembled(mass, mass * center, second + mass * center * center.transpose())),
          changes.str()};
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
