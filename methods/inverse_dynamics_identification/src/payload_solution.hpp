// SPDX-License-Identifier: Apache-2.0
/// @file
/// The body that sums of filtered rows tell of, and how sure it is.
#pragma once

#include <Eigen/Core>

namespace inverse_dynamics_identification {
inline namespace v2 {

using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;

/// Least squares in the ten numbers of the body: 1/2 phi' A phi - b' phi.
struct Normal {
  Matrix10 A = Matrix10::Zero();
  Vector10 b = Vector10::Zero();
};

/// The prior of the pseudo-inertia: tr(P0^-1 P) - log det P.
class BodyPrior {
 public:
  /// P0: mass and center of mass, and the standard deviation of mass about it, m.
  BodyPrior(double mass, const Eigen::Vector3d& center, double extent);

  /// The body P0.
  const Vector10& body() const { return body_; }

  /// Infinity where phi isn't a body; P: its pseudo-inertia.
  double value(const Vector10& phi) const;
  Vector10 gradient(const Vector10& phi) const;
  Matrix10 hessian(const Vector10& phi) const;

  /// What the prior says of the inertia whatever mass and first moments are: rows and columns of
  /// those are zero, as the prior's are those of the estimate.
  Matrix10 inertiaInformation(const Vector10& phi) const;

 private:
  Vector10 body_;
  Eigen::Matrix4d inverse_;  // P0^-1
};

/// The minimum of least squares and prior, from the body of the prior on: damped Newton steps.
Vector10 mostLikelyBody(const Normal& normal, const BodyPrior& prior);

/// What is added in every direction, so that one without information has a large variance rather
/// than rounding's, which would mix into the others.
Matrix10 leastInformation(const Matrix10& information);

/// The inverse of an information matrix: very large, but finite, where it says nothing.
Matrix10 covarianceOf(const Matrix10& information);

/// The upper 97.5 % point of Student's t; degrees_of_freedom >= 1, infinity included.
double studentT(double degrees_of_freedom);

/// Derivative of the inertia about the center of mass by phi, along a direction.
Eigen::Matrix3d centralInertiaChange(const Vector10& phi, const Vector10& direction);

}  // namespace v2
}  // namespace inverse_dynamics_identification
