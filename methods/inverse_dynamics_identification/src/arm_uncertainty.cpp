// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_uncertainty.hpp"

#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <memory>
#include <string>
#include <utility>

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Regressor;
using Index = Eigen::Index;

const Regressor& regressorOf(const InverseDynamicsSolver* solver) {
  const auto* const regressor = dynamic_cast<const Regressor*>(solver);
  if (regressor == nullptr) {
    throw InvalidParameterValueException(
        "arm uncertainty: solver", "", "one with the capability Regressor",
        solver == nullptr ? "none" : "one without it", "take the solver of the identified model");
  }
  return *regressor;
}

/// Own columns of each joint; none where the factor isn't one of so many joints.
Index ownColumnsOf(const ArmUncertainty& uncertainty, Index joints) {
  for (const FrictionTerms terms :
       {FrictionTerms::kStep, FrictionTerms::kLoad, FrictionTerms::kStribeck}) {
    if (uncertainty.factor.rows() == joints * (10 + ownColumns(terms))) return ownColumns(terms);
  }
  return 0;
}

void checkFits(const ArmUncertainty& uncertainty, Index joints) {
  const auto laws = static_cast<Index>(uncertainty.friction.size());
  if (laws == joints && ownColumnsOf(uncertainty, joints) > 0 && uncertainty.factor.allFinite()) {
    return;
  }
  throw InvalidParameterValueException(
      "arm uncertainty", "",
      std::to_string(joints) +
          " laws of friction and finite numbers in 16, 17 or 19 rows per joint",
      std::to_string(laws) + " laws and " + std::to_string(uncertainty.factor.rows()) + " rows" +
          (uncertainty.factor.allFinite() ? "" : ", not all of them finite"),
      "take that of the solver's own model");
}

}  // namespace

ArmDeviations::ArmDeviations(std::shared_ptr<const InverseDynamicsSolver> solver,
                             const ArmUncertainty& uncertainty)
    : solver_(std::move(solver)),
      regressor_(&regressorOf(solver_.get())),
      friction_(uncertainty.friction) {
  const Index n = solver_->jointCount();
  checkFits(uncertainty, n);
  factor_ = uncertainty.factor.transpose();
  Y_ = Eigen::MatrixXd::Zero(n, 10 * n);
  gravity_.setZero(n);
  own_.setZero(ownColumnsOf(uncertainty, n));
}

void ArmDeviations::compute(const inverse_dynamics_solver::ConstVectorRef& q,
                            const inverse_dynamics_solver::ConstVectorRef& qd,
                            const inverse_dynamics_solver::ConstVectorRef& qdd,
                            inverse_dynamics_solver::MatrixRef D) {
  const Index n = Y_.rows(), columns = own_.size();
  regressor_->getRegressor(q, qd, qdd, Y_);
  solver_->getGravityVector(q, gravity_);
  for (Index j = 0; j < n; ++j) {
    const StepFriction& law = friction_[static_cast<std::size_t>(j)];
    ownColumnsAt(law, qd[j], qdd[j], std::abs(gravity_[j]), own_);
    // a joint moves its own link and those after it
    const Index moved = 10 * (n - j);
    D.col(j).noalias() = factor_.middleCols(10 * j, moved) * Y_.row(j).tail(moved).transpose();
    D.col(j).noalias() += factor_.middleCols(10 * n + columns * j, columns) * own_;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
