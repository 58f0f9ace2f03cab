// SPDX-License-Identifier: Apache-2.0

/// @file
/// The terms of the cost beside the data: of pseudo-inertias, and of single coefficients.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_identification/consistent_fit.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Of a link: [m, mc, I].
constexpr Eigen::Index kParameters = 10;

/// The sum of gamma [tr(P0^-1 P) - log det P] over the links and of the penalties of own columns, as
/// a function of all unknowns.
class Penalties {
 public:
  /// @throws chain_dynamics::ModelError  a link that is no body.
  explicit Penalties(const Prior& prior);

  Eigen::Index unknowns() const;
  /// The solution where gamma is large: the prior's links, and coefficients within their limits.
  Eigen::VectorXd start() const;
  /// Moves coefficients that are beyond their limits to where they are at the start.
  void limit(Eigen::VectorXd& x) const;
  /// Infinite where a link is no body or a coefficient is beyond its limits.
  double value(double strength, const Eigen::VectorXd& x) const;
  /// Adds the derivatives, at an x with a finite value.
  void addDerivatives(double strength, const Eigen::VectorXd& x, Eigen::VectorXd& gradient,
                      Eigen::MatrixXd& hessian) const;

 private:
  Eigen::Index links() const { return static_cast<Eigen::Index>(inverses_.size()); }

  std::vector<LinkParameters> described_;
  std::vector<Eigen::Matrix4d> inverses_;  // P0^-1
  std::vector<OwnColumn> own_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
