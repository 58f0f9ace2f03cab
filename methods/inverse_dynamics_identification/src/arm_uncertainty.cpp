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
#include <vector>

#include "own_rows.hpp"

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

/// The rows whose unknowns the factor has; null: of no terms of friction.
std::shared_ptr<const OwnRows> rowsOf(const ArmUncertainty& uncertainty, Index joints,
                                      Index links) {
  for (const FrictionTerms terms : {FrictionTerms::kStep, FrictionTerms::kLoad,
                                    FrictionTerms::kStribeck, FrictionTerms::kMemory}) {
    auto rows = std::make_shared<const OwnRows>(uncertainty.coupling, uncertainty.springs, joints,
                                                terms, false);
    if (uncertainty.factor.rows() == 10 * links + rows->unknownCount()) return rows;
  }
  return nullptr;
}

void checkFits(const ArmUncertainty& uncertainty, Index joints, Index links) {
  const auto laws = static_cast<Index>(uncertainty.friction.size());
  const auto& C = uncertainty.coupling;
  const auto springs = static_cast<Index>(uncertainty.springs.size());
  const bool is_of_joints =
      C.size() == 0 ? laws == joints : C.cols() == joints && C.rows() == laws && laws >= joints;
  if (is_of_joints && (springs == 0 || springs == joints) && uncertainty.factor.allFinite() &&
      rowsOf(uncertainty, joints, links) != nullptr) {
    return;
  }
  throw InvalidParameterValueException(
      "arm uncertainty", "",
      "laws of friction of " + std::to_string(joints) +
          " joints and finite numbers in 10 rows per link (" + std::to_string(links) +
          ") and 6, 7, 9 or 11 per joint",
      std::to_string(laws) + " laws and " + std::to_string(uncertainty.factor.rows()) + " rows" +
          (uncertainty.factor.allFinite() ? "" : ", not all of them finite"),
      "take that of the solver's own model");
}

/// Numbers of links before the first that each joint moves, whose columns of the regressor are zero: in a
/// state in which no other are.
std::vector<Index> numbersBefore(const InverseDynamicsSolver& solver, const Regressor& regressor) {
  const Index n = solver.jointCount();
  const Eigen::MatrixXd Y = regressor.getRegressor(Eigen::VectorXd::LinSpaced(n, 0.3, 1.1),
                                                   Eigen::VectorXd::LinSpaced(n, -1.2, 2.1),
                                                   Eigen::VectorXd::LinSpaced(n, 3.1, 2.0));
  std::vector<Index> before(static_cast<std::size_t>(n), 0);
  for (Index j = 0; j < n; ++j) {
    Index& first = before[static_cast<std::size_t>(j)];
    while (first + 10 < Y.cols() && Y.row(j).segment(first, 10).isZero(0)) first += 10;
  }
  return before;
}

}  // namespace

ArmDeviations::ArmDeviations(std::shared_ptr<const InverseDynamicsSolver> solver,
                             const ArmUncertainty& uncertainty)
    : solver_(std::move(solver)), regressor_(&regressorOf(solver_.get())), of_(uncertainty) {
  const Index n = solver_->jointCount();
  const Index links = regressor_->linkCount();
  checkFits(uncertainty, n, links);
  factor_ = uncertainty.factor.transpose();
  Y_ = Eigen::MatrixXd::Zero(n, 10 * links);
  before_ = numbersBefore(*solver_, *regressor_);
  gravity_.setZero(n);
  rows_ = rowsOf(uncertainty, n, links);
  law_.setZero(rows_->lawColumns());
  own_ = Eigen::MatrixXd::Zero(n, rows_->columns());
}

void ArmDeviations::compute(const inverse_dynamics_solver::ConstVectorRef& q,
                            const inverse_dynamics_solver::ConstVectorRef& qd,
                            const inverse_dynamics_solver::ConstVectorRef& qdd,
                            inverse_dynamics_solver::MatrixRef D) {
  const Index n = Y_.rows();
  regressor_->getRegressor(q, qd, qdd, Y_);
  solver_->getGravityVector(q, gravity_);
  const FittedPresliding none;
  fillOwnRows(
      *rows_, of_.coupling, of_.springs, of_.friction, q, qd, qdd, gravity_,
      [&](Index /*law*/) -> const FittedPresliding& { return none; }, law_, own_);
  for (Index j = 0; j < n; ++j) {
    const Index before = before_[static_cast<std::size_t>(j)], moved = Y_.cols() - before;
    D.col(j).noalias() = factor_.middleCols(before, moved) * Y_.row(j).tail(moved).transpose();
    const std::vector<int>& unknowns = rows_->unknowns()[static_cast<std::size_t>(j)];
    for (Index c = 0; c < own_.cols(); ++c) {
      const int unknown = unknowns[static_cast<std::size_t>(c)];
      if (unknown >= 0) D.col(j) += own_(j, c) * factor_.col(Y_.cols() + unknown);
    }
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_identification
