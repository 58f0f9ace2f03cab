// SPDX-License-Identifier: Apache-2.0
#include "nuisance.hpp"

#include <Eigen/Cholesky>
#include <vector>

namespace inverse_dynamics_identification {
inline namespace v2 {

Nuisance::Nuisance(Eigen::Index joints, Eigen::Index deviations)
    : deviations_(deviations),
      sum_(deviations + joints, 11 + deviations + joints),
      factor_(count(), count()),
      solved_(count(), 11),
      w_(count()) {}

void Nuisance::begin(const std::vector<OffsetPrior>& offsets) {
  body_ = {};
  sum_.setZero();
  auto by_w = sum_.rightCols(count());
  by_w.diagonal().setOnes();
  Eigen::Index o = deviations_;
  for (const OffsetPrior& prior : offsets) {
    by_w(o, o) = 1.0 / prior.variance;
    sum_(o++, 10) = prior.mean / prior.variance;
  }
}

void Nuisance::add(Eigen::Index joint, const JointSums& sums, double sign) {
  const Eigen::Index K = deviations_, o = K + joint;
  auto by_w = sum_.rightCols(count());
  body_.A += sign * sums.body.topLeftCorner<10, 10>();
  body_.b += sign * sums.body.block<10, 1>(0, 11);
  sum_.row(o).head<10>() += sign * sums.body.block<1, 10>(10, 0);
  sum_(o, 10) += sign * sums.body(10, 11);
  by_w(o, o) += sign * sums.body(10, 10);
  sum_.topLeftCorner(K, 10) += sign * sums.arm.leftCols<10>();
  sum_.col(10).head(K) += sign * sums.arm.col(11);
  by_w.row(o).head(K) += sign * sums.arm.col(10).transpose();
  by_w.topLeftCorner(K, K) += sign * sums.arm.rightCols(K);
}

Normal Nuisance::solve() {
  factor_ = sum_.rightCols(count());
  solved_ = sum_.leftCols<11>();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(factor_);
  factor_.triangularView<Eigen::Lower>().solveInPlace(solved_);
  Normal normal = body_;
  normal.A.noalias() -= solved_.leftCols<10>().transpose().lazyProduct(solved_.leftCols<10>());
  normal.b.noalias() -= solved_.leftCols<10>().transpose().lazyProduct(solved_.col(10));
  return normal;
}

OffsetPrior Nuisance::offset(Eigen::Index joint, const Vector10& phi, const Matrix10& V) {
  w_.setZero();
  w_[deviations_ + joint] = 1.0;
  factor_.triangularView<Eigen::Lower>().solveInPlace(w_);
  const Vector10 slope = solved_.leftCols<10>().transpose() * w_;  // of the offset, by minus phi
  return {solved_.col(10).dot(w_) - slope.dot(phi), w_.squaredNorm() + slope.dot(V * slope)};
}

void Nuisance::deviations(const Vector10& phi, Eigen::Ref<Eigen::VectorXd> z) {
  w_ = solved_.col(10);
  w_.noalias() -= solved_.leftCols<10>() * phi;
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(w_);
  z = w_.head(deviations_);
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
