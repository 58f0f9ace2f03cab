// SPDX-License-Identifier: Apache-2.0
#include "arm_normal.hpp"

#include <Eigen/Cholesky>

namespace inverse_dynamics_identification {
inline namespace v2 {

ArmNormal::ArmNormal(Eigen::Index deviations)
    : sum_(deviations, 11 + deviations),
      factor_(deviations, deviations),
      solved_(deviations, 11),
      slope_(deviations) {}

void ArmNormal::begin() {
  sum_.setZero();
  sum_.rightCols(deviations()).diagonal().setOnes();
}

void ArmNormal::add(const JointSums& joint, const OffsetPrior& prior, double sign) {
  if (deviations() == 0) return;
  const OffsetLine line = offsetLine(joint.body, prior);
  const auto coupling = joint.arm.col(10);
  sum_.leftCols<10>() += sign * joint.arm.leftCols<10>();
  sum_.col(10) += sign * (joint.arm.col(11) - line.right * coupling);
  sum_.rightCols(deviations()) += sign * joint.arm.rightCols(deviations());
  slope_ = sign * coupling;
  sum_.leftCols<10>().noalias() -= slope_ * line.slope.transpose();
  slope_ = coupling;
  sum_.rightCols(deviations())
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(slope_, -sign * line.variance);
}

Normal ArmNormal::loss() {
  Normal loss;
  if (deviations() == 0) return loss;
  factor_ = sum_.rightCols(deviations());
  solved_ = sum_.leftCols<11>();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(factor_);
  factor_.triangularView<Eigen::Lower>().solveInPlace(solved_);
  loss.A.noalias() = solved_.leftCols<10>().transpose().lazyProduct(solved_.leftCols<10>());
  loss.b.noalias() = solved_.leftCols<10>().transpose().lazyProduct(solved_.col(10));
  return loss;
}

OffsetLine ArmNormal::without(OffsetLine line, const JointSums& joint) {
  if (deviations() == 0) return line;
  slope_ = line.variance * joint.arm.col(10);
  factor_.triangularView<Eigen::Lower>().solveInPlace(slope_);
  line.slope.noalias() -= solved_.leftCols<10>().transpose() * slope_;
  line.right -= solved_.col(10).dot(slope_);
  line.variance += slope_.squaredNorm();
  return line;
}

void ArmNormal::solve(const Vector10& phi, Eigen::Ref<Eigen::VectorXd> z) const {
  if (deviations() == 0) return;
  z = solved_.col(10);
  z.noalias() -= solved_.leftCols<10>() * phi;
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(z);
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
