// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/momentum_observer.hpp"

#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <string>
#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

const char* const kObserver = "momentum observer";

}  // namespace

MomentumObserver::MomentumObserver(std::shared_ptr<const InverseDynamicsSolver> solver,
                                   const EstimatorOptions& options)
    : ExternalTorqueEstimator(std::move(solver), options, kObserver) {
  if (!model().inertiaIsPhysical()) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        std::string(kObserver) + ": solver", "its inertia matrix isn't physical",
        "a symmetric, positive definite H(q), whose product with qd is a momentum",
        "inertiaIsPhysical() is false",
        "use AccelerationResidual, or a solver made from the robot's URDF");
  }
  const Eigen::Index n = jointCount();
  for (auto* H : {&H0_, &H_}) *H = Eigen::MatrixXd::Zero(n, n);
  for (OwnedVector* vector : {&bias0_, &bias_, &friction_, &change_}) vector->setZero(n);
}

void MomentumObserver::begin(const OwnedVector& q, const OwnedVector& qd) { terms(q, qd); }

void MomentumObserver::meanTorques(const OwnedVector& /*q0*/, const OwnedVector& qd0,
                                   const OwnedVector& q1, const OwnedVector& qd1, double period,
                                   VectorRef bias, VectorRef inertial) {
  std::swap(H0_, H_);
  std::swap(bias0_, bias_);
  terms(q1, qd1);
  // together (change of p - integral of C^T qd) / T + g + f
  change_ = (0.5 / period) * (qd1 - qd0);
  inertial.noalias() = H0_.lazyProduct(change_);
  inertial.noalias() += H_.lazyProduct(change_);
  bias = 0.5 * (bias0_ + bias_);
}

void MomentumObserver::terms(const OwnedVector& q, const OwnedVector& qd) {
  model().components(q, qd, H_, bias_);
  model().moveFriction(q);
  model().friction(q, qd, friction_);
  bias_ += friction_;
}

}  // namespace v2
}  // namespace inverse_dynamics_control
