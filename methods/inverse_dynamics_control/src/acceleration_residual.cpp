// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/acceleration_residual.hpp"

#include <memory>
#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {

AccelerationResidual::AccelerationResidual(std::shared_ptr<const InverseDynamicsSolver> solver,
                                           const EstimatorOptions& options)
    : ExternalTorqueEstimator(std::move(solver), options, "acceleration residual") {
  H_ = Eigen::MatrixXd::Zero(jointCount(), jointCount());
  for (OwnedVector* vector : {&q_, &qd_, &qdd_, &friction_}) vector->setZero(jointCount());
}

void AccelerationResidual::begin(const OwnedVector& /*q*/, const OwnedVector& /*qd*/) {}

void AccelerationResidual::meanTorques(const OwnedVector& q0, const OwnedVector& qd0,
                                       const OwnedVector& q1, const OwnedVector& qd1, double period,
                                       VectorRef bias, VectorRef inertial) {
  q_ = 0.5 * (q0 + q1);
  qd_ = 0.5 * (qd0 + qd1);
  qdd_ = (qd1 - qd0) / period;
  model().components(q_, qd_, H_, bias);
  model().moveFriction(q_);
  model().friction(q_, qd_, friction_);
  bias += friction_;
  inertial.noalias() = H_.lazyProduct(qdd_);
}

}  // namespace v2
}  // namespace inverse_dynamics_control
