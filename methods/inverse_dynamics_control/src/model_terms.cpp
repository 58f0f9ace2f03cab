// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/model_terms.hpp"

#include <algorithm>
#include <chain_dynamics/owned.hpp>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

constexpr double kFast = 1e3;  // rad/s: where all of friction but the viscous part is constant

/// The rest that shares leave, for each joint.
OwnedVector left(const Shares& shares, const std::string& where,
                 const std::vector<std::string>& joint_names) {
  OwnedVector each = shares.values();
  if (each.size() == 1) {
    each = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(joint_names.size()), each[0]);
  }
  requireJointNumbers(where, each, Range::kShare, "1", joint_names);
  each = 1.0 - each.array();
  return each;
}

/// `share f`, and no NaN where nothing is left of infinite friction.
double part(double share, double f) { return share == 0 && std::isinf(f) ? 0.0 : share * f; }

/// Sum of `V(j, i) velocity(i)`, of coefficients that aren't zero.
template <class Velocity>
double viscousOf(const chain_dynamics::OwnedMatrix& V, Eigen::Index j, const Velocity& velocity) {
  double sum = 0;
  for (Eigen::Index i = 0; i < V.cols(); ++i) {
    if (V(j, i) != 0) sum += V(j, i) * velocity(i);
  }
  return sum;
}

}  // namespace

ModelTerms::ModelTerms(std::shared_ptr<const InverseDynamicsSolver> solver,
                       const Compensated& compensated, const std::string& law)
    : solver_(std::move(solver)) {
  if (solver_ == nullptr) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        law + ": solver", "missing", "an initialized solver", "none", "load one with SolverLoader");
  }
  const Eigen::Index n = solver_->jointCount();
  H_ = Eigen::MatrixXd::Zero(n, n);
  bias_ = Eigen::VectorXd::Zero(n);
  g_ = Eigen::VectorXd::Zero(n);
  forth_ = Eigen::VectorXd::Constant(n, kFast);
  back_ = -forth_;
  memory_ = inverse_dynamics_solver::frictionState(*solver_);
  const auto of = [&](const Shares& shares, const char* term) {
    return left(shares, law + ": compensated: " + term, jointNames());
  };
  gravity_ = of(compensated.gravity, "gravity");
  coriolis_ = of(compensated.coriolis, "coriolis");
  friction_ = of(compensated.friction, "friction");
  viscous_ = of(compensated.viscous.value_or(compensated.friction), "viscous");
  V_ = Eigen::MatrixXd::Zero(n, n);
  if ((viscous_ - friction_).isZero(0)) return;
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd fast = kFast * Eigen::VectorXd::Unit(n, i);
    V_.col(i) =
        (solver_->getFrictionVector(q, 2 * fast) - solver_->getFrictionVector(q, fast)) / kFast;
  }
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
  bias.array() *= coriolis_.array();
  if (!gravity_.isZero(0)) bias += gravity_.cwiseProduct(g_);
}

void ModelTerms::gravity(const ConstVectorRef& q, VectorRef g) const {
  g.setZero();
  if (gravity_.isZero(0)) return;
  solver_->getGravityVector(q, g);
  g.array() *= gravity_.array();
}

void ModelTerms::friction(const ConstVectorRef& q, const ConstVectorRef& v, VectorRef f) const {
  f.setZero();
  if (friction_.isZero(0) && viscous_.isZero(0)) return;
  solver_->getFrictionVector(q, v, f);
  memory_.addTo(v, f);
  for (Eigen::Index j = 0; j < f.size(); ++j) {
    const double viscous = viscousOf(V_, j, [&](Eigen::Index i) { return v[i]; });
    if (viscous == 0) {
      f[j] = part(friction_[j], f[j]);
    } else if (std::isinf(f[j])) {
      f[j] = part(viscous_[j], f[j]);
    } else {
      f[j] = friction_[j] * (f[j] - viscous) + viscous_[j] * viscous;
    }
  }
}

void ModelTerms::rememberedFriction(VectorRef f) const noexcept {
  f.setZero();
  for (const OwnedVector* velocity : {&forth_, &back_}) memory_.addTo(*velocity, f);
  f.array() *= 0.5 * friction_.array();  // steps of opposite signs cancel
}

double ModelTerms::lostDamping(Eigen::Index j, const ConstVectorRef& qd,
                               const ConstVectorRef& qd_reference) const {
  return std::max(0.0, friction_[j] - viscous_[j]) *
         viscousOf(V_, j, [&](Eigen::Index i) { return qd_reference[i] - qd[i]; });
}

}  // namespace v2
}  // namespace inverse_dynamics_control
