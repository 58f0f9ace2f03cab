// SPDX-License-Identifier: Apache-2.0
/// @file
/// Unknowns besides the body: an offset of each joint, and deviations of the arm's model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "payload_solution.hpp"
#include "payload_sums.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Prior of an offset: N m, and its square.
struct OffsetPrior {
  double mean = 0.0;
  double variance = 1.0;
};

/// Normal equations of a body phi and of w, which is at its best value for each phi: K standard normal
/// deviations and n offsets.
///
/// Real time: no allocation up to n + K = 128.
class Nuisance {
 public:
  Nuisance(Eigen::Index joints, Eigen::Index deviations);

  /// Begins with what is known of w beforehand.
  void begin(const std::vector<OffsetPrior>& offsets);
  /// Adds the sums of a joint; or, with sign -1, takes them away.
  void add(Eigen::Index joint, const JointSums& sums, double sign = 1.0);

  /// The equations of the body. The functions below are of the same sum.
  Normal solve();
  /// An offset, and its variance where the body has the covariance V.
  OffsetPrior offset(Eigen::Index joint, const Vector10& phi, const Matrix10& V);
  /// The deviations at a body.
  void deviations(const Vector10& phi, Eigen::Ref<Eigen::VectorXd> z);

 private:
  Eigen::Index count() const { return sum_.rows(); }

  Eigen::Index deviations_;
  Normal body_;             // w held at zero
  Eigen::MatrixXd sum_;     // by the body, right hand side, lower triangle by w
  Eigen::MatrixXd factor_;  // Cholesky's, of the part by w
  Eigen::MatrixXd solved_;  // factor^-1 [by the body, right hand side]
  Eigen::VectorXd w_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification
