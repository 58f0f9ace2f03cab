// SPDX-License-Identifier: Apache-2.0

#include "evaluation.hpp"

#include "user_error.hpp"

namespace inverse_dynamics_ros {

Evaluation evaluate(const inverse_dynamics_evaluation::JointLog& log,
                    const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                    const EvaluationOptions& options) {
  Evaluation result;
  result.joint_names = solver.jointNames();
  result.accelerations = inverse_dynamics_evaluation::logAccelerations(
      log, options.method, options.cutoff, options.rules);
  result.computed = solver.getTorquesBatch(log.q, log.qd, result.accelerations.qdd);
  if (options.effort.without_gravity) {
    result.computed -= solver.getGravityVectorBatch(log.q);
  }
  if (log.effort.size() > 0) {
    result.measured = options.effort.drive_gains.asDiagonal() * log.effort;
    result.errors = inverse_dynamics_evaluation::metrics(result.computed, result.measured);
    result.errors_of_kept = inverse_dynamics_evaluation::metrics(result.computed, result.measured,
                                                                 result.accelerations.samples.kept);
  }
  return result;
}

inverse_dynamics_evaluation::SampleRules rulesWithout(const std::vector<std::string>& names) {
  inverse_dynamics_evaluation::SampleRules rules;
  for (const std::string& name : names) {
    if (name == "repeated") {
      rules.repeated = false;
    } else if (name == "non-increasing") {
      rules.non_increasing = false;
    } else if (name == "time-base") {
      rules.time_base = false;
    } else if (name == "start-transient") {
      rules.start_transient = false;
    } else {
      throw UserError("parameter 'without_rules'",
                      "some of repeated, non-increasing, time-base, start-transient",
                      "'" + name + "'", "correct it");
    }
  }
  return rules;
}

}  // namespace inverse_dynamics_ros
