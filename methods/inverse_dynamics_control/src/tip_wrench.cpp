// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/tip_wrench.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>
#include <string>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::Kinematics;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const char* const kTipWrench = "tip wrench";

const Kinematics* kinematicsOf(const inverse_dynamics_solver::InverseDynamicsSolver* solver) {
  const std::string where = std::string(kTipWrench) + ": solver";
  if (solver == nullptr) {
    throw InvalidParameterValueException(where, "missing", "an initialized solver", "none",
                                         "load one with SolverLoader");
  }
  const auto* kinematics = dynamic_cast<const Kinematics*>(solver);
  if (kinematics == nullptr) {
    throw InvalidParameterValueException(where, "no Jacobian",
                                         "a solver with the capability Kinematics", "none of it",
                                         "use one of this project's solvers");
  }
  return kinematics;
}

}  // namespace

const char* text(WrenchStatus status) noexcept {
  switch (status) {
    case WrenchStatus::kOk:
      return "an estimate";
    case WrenchStatus::kNotFinite:
      return "a position, a torque or the Jacobian isn't finite: no wrench";
    case WrenchStatus::kSolverFailed:
      return "the solver failed: no wrench";
    case WrenchStatus::kWrongSize:
      return "an argument hasn't one number per joint: no wrench";
  }
  return "unknown status";
}

TipWrench::TipWrench(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
                     const WrenchOptions& options)
    : solver_(std::move(solver)), kinematics_(kinematicsOf(solver_.get())), noise_(options.noise) {
  const std::string name = kTipWrench;
  const Eigen::Index n = solver_->jointCount();
  requireJointNumbers(name + ": noise", noise_, Range::kPositive, "N m", solver_->jointNames());
  requireNumber(name + ": force", options.force, Range::kPositive, "N");
  requireNumber(name + ": torque", options.torque, Range::kPositive, "N m");
  size_.resize(6);
  size_ << options.force, options.force, options.force, options.torque, options.torque,
      options.torque;
  J_ = Eigen::MatrixXd::Zero(6, n);
  A_ = Eigen::MatrixXd::Zero(n, 6);
  scaled_.setZero(n);
  ratio_.setZero(6);
  directions_ = Eigen::MatrixXd::Zero(6, 6);
}

WrenchStatus TipWrench::update(const Eigen::Ref<const Eigen::VectorXd>& q,
                               const Eigen::Ref<const Eigen::VectorXd>& torques) noexcept {
  clear();
  const Eigen::Index n = jointCount();
  if (q.size() != n || torques.size() != n) return WrenchStatus::kWrongSize;
  try {
    kinematics_->getTipJacobian(q, J_);
  } catch (...) {
    return WrenchStatus::kSolverFailed;
  }
  if (!q.allFinite() || !torques.allFinite() || !J_.allFinite()) return WrenchStatus::kNotFinite;

  for (Eigen::Index i = 0; i < 6; ++i) {
    A_.col(i) = size_[i] * J_.row(i).transpose().cwiseQuotient(noise_);
  }
  scaled_ = torques.cwiseQuotient(noise_);
  // A = U X V^T:  u = V (X^2 + 1)^-1 V^T A^T S^-1 tau_ext
  Matrix6 normal;
  normal.noalias() = A_.transpose().lazyProduct(A_);
  Vector6 right;
  right.noalias() = A_.transpose().lazyProduct(scaled_);
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(normal);
  const Vector6 squares = eigen.eigenvalues().cwiseMax(0.0).reverse();
  const Matrix6 V = eigen.eigenvectors().rowwise().reverse();
  const Vector6 along = V.transpose().lazyProduct(right);
  const Vector6 u = V.lazyProduct(along.cwiseQuotient((squares.array() + 1.0).matrix()));
  if (!u.allFinite()) return WrenchStatus::kNotFinite;
  ratio_ = squares.cwiseSqrt();
  directions_ = size_.asDiagonal() * V;
  const Vector6 w = size_.cwiseProduct(u);
  wrench_.force = w.head<3>();
  wrench_.torque = w.tail<3>();
  return WrenchStatus::kOk;
}

Eigen::Index TipWrench::unseen() const noexcept {
  return std::count_if(ratio_.data(), ratio_.data() + 6, [](double x) { return !(x >= 1.0); });
}

void TipWrench::clear() noexcept {
  ratio_.setZero();
  directions_.setZero();
  wrench_.force.setZero();
  wrench_.torque.setZero();
}

}  // namespace v2
}  // namespace inverse_dynamics_control
