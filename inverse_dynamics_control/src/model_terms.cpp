// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/model_terms.hpp"

#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {

ModelTerms::ModelTerms(std::shared_ptr<const InverseDynamicsSolver> solver,
                       const Compensated& compensated, const std::string& law)
    : solver_(std::move(solver)), compensated_(compensated) {
  if (solver_ == nullptr) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        inverse_dynamics_solver::errorText(law + ": solver", "missing", "an initialized solver",
                                           "none", "load one with SolverLoader"));
  }
  const Eigen::Index n = solver_->jointCount();
  H_ = Eigen::MatrixXd::Zero(n, n);
  bias_ = Eigen::VectorXd::Zero(n);
  g_ = Eigen::VectorXd::Zero(n);
}

void ModelTerms::torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& a,
                         VectorRef tau) {
  components(q, qd, H_, bias_);
  tau.noalias() = H_.lazyProduct(a);
  tau += bias_;
}

void ModelTerms::components(const ConstVectorRef& q, const ConstVectorRef& qd,
                            inverse_dynamics_solver::MatrixRef H, VectorRef bias) {
  solver_->getDynamicComponents(q, qd, H, bias, g_);
  if (compensated_.coriolis) bias.setZero();
  if (!compensated_.gravity) bias += g_;
}

void ModelTerms::gravity(const ConstVectorRef& q, VectorRef g) const {
  if (compensated_.gravity) {
    g.setZero();
  } else {
    solver_->getGravityVector(q, g);
  }
}

void ModelTerms::friction(const ConstVectorRef& q, const ConstVectorRef& v, VectorRef f) const {
  if (compensated_.friction) {
    f.setZero();
  } else {
    solver_->getFrictionVector(q, v, f);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_control
