// SPDX-License-Identifier: Apache-2.0

#include "evaluation.hpp"

namespace inverse_dynamics_ros {

Evaluation evaluate(const inverse_dynamics_evaluation::JointLog& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options) {
  Evaluation result;
  result.computed.resize(log.q.rows(), log.q.cols());
  result.measured.resize(log.effort.rows(), log.effort.cols());
  const auto take = [&](const inverse_dynamics_evaluation::EvaluatedSamples& next) {
    result.computed.middleCols(next.first, next.computed.cols()) = next.computed;
    if (next.measured.size() > 0) {
      result.measured.middleCols(next.first, next.measured.cols()) = next.measured;
    }
  };
  static_cast<inverse_dynamics_evaluation::Evaluation&>(result) =
      inverse_dynamics_evaluation::evaluate(log, solver, options, take);
  return result;
}

}  // namespace inverse_dynamics_ros
