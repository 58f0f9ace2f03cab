// SPDX-License-Identifier: Apache-2.0
/// @file
/// Deviations of the arm's model in the normal equations of a body.
#pragma once

#include <Eigen/Core>

#include "payload_solution.hpp"
#include "payload_sums.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Rows of normal equations that belong to K standard normal deviations z, and what the rows of the
/// body lose where z is at its best value for each body. Of no deviations, nothing is lost.
///
/// Real time: no allocation up to K = 120.
class ArmNormal {
 public:
  explicit ArmNormal(Eigen::Index deviations);

  Eigen::Index deviations() const { return sum_.rows(); }

  /// The sum begins with what is known of z beforehand, or with another sum.
  void begin();
  void begin(const ArmNormal& other) { sum_ = other.sum_; }
  /// Adds a joint whose offset is at its best value; or, with sign -1, takes it away.
  void add(const JointSums& joint, const OffsetPrior& prior, double sign = 1.0);

  /// What the rows of the body lose. The functions below are of the same sum.
  Normal loss();
  /// The offset of a joint as it depends on the body alone.
  OffsetLine without(OffsetLine line, const JointSums& joint);
  /// z at a body.
  void solve(const Vector10& phi, Eigen::Ref<Eigen::VectorXd> z) const;

 private:
  Eigen::MatrixXd sum_;     // K x (11 + K): by the body, right hand side, lower triangle by z
  Eigen::MatrixXd factor_;  // Cholesky's, of the part by z
  Eigen::MatrixXd solved_;  // K x 11: factor^-1 [by the body, right hand side]
  Eigen::VectorXd slope_;   // K
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
