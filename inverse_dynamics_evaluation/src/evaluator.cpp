// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/evaluator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using inverse_dynamics_solver::InverseDynamicsSolver;

// Samples that the solver gets at once: whole groups of those that it computes in parallel, and few
// enough to stay in the cache.
constexpr Index kBlock = 4096;

template <class Visit>
void forEachBlock(Index samples, Visit visit) {
  for (Index first = 0; first < samples; first += kBlock) {
    visit(first, std::min(kBlock, samples - first));
  }
}

// Runs from where it is made.
class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

// Errors say which recording they are of.
LogAccelerations accelerationsOf(const JointLogView& log, const EvaluationOptions& options) {
  try {
    return logAccelerations(log, options.method, options.cutoff, options.rules);
  } catch (const EvaluationError& error) {
    const std::string topic = options.topic.empty() ? "" : ": " + options.topic;
    throw EvaluationError(options.recording + topic + ": " + error.what());
  }
}

// Computed torques of a log, block by block.
class Torques {
 public:
  Torques(const JointLogView& log, const InverseDynamicsSolver& solver, const OwnedMatrix& qdd,
          const EvaluationOptions& options)
      : log_(log), solver_(solver), qdd_(qdd), options_(options) {}

  MatrixXd computed(Index first, Index count) const {
    MatrixXd torques =
        solver_.getTorquesBatch(log_.q.middleCols(first, count), log_.qd.middleCols(first, count),
                                qdd_.middleCols(first, count));
    requirePossibleTorques(options_.recording, solver_.jointNames(), options_.units, torques,
                           first);
    return torques;
  }

  MatrixXd gravity(Index first, Index count) const {
    return solver_.getGravityVectorBatch(log_.q.middleCols(first, count));
  }

 private:
  const JointLogView& log_;
  const InverseDynamicsSolver& solver_;
  const OwnedMatrix& qdd_;
  const EvaluationOptions& options_;
};

// The columns where `mask` is true.
MatrixXd selected(const Eigen::Ref<const MatrixXd>& columns, const Mask& mask) {
  MatrixXd result(columns.rows(), mask.count());
  Index next = 0;
  for (Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) {
      result.col(next++) = columns.col(k);
    }
  }
  return result;
}

EffortVerdict verdictOf(const Torques& torques, const JointLogView& log, const Mask& kept,
                        const EffortOptions& options) {
  const bool recorded = log.effort.size() > 0;
  EffortSums sums(recorded ? kept.count() : 0, log.q.rows(), options.drive_gains);
  forEachBlock(recorded ? log.q.cols() : 0, [&](Index first, Index count) {
    const Mask mask = kept.segment(first, count);
    sums.add(selected(torques.computed(first, count), mask),
             selected(torques.gravity(first, count), mask),
             selected(log.effort.middleCols(first, count), mask));
  });
  return sums.verdict();
}

// Errors of the computed torques, once it is known what efforts mean; hands over the series.
void compare(const Torques& torques, const JointLogView& log, const TakeSamples& take,
             Evaluation& result) {
  const Mask& kept = result.accelerations.samples.kept;
  const bool recorded = log.effort.size() > 0;
  ErrorSums all(log.q.rows());
  ErrorSums of_kept(log.q.rows());
  forEachBlock(log.q.cols(), [&](Index first, Index count) {
    MatrixXd computed = torques.computed(first, count);
    if (result.effort.meaning == kTorqueWithoutGravity) {
      computed -= torques.gravity(first, count);
    }
    OwnedMatrix measured;
    if (recorded) {
      measured = result.effort.torques(log.effort.middleCols(first, count));
      all.add(computed, measured, first);
      of_kept.add(computed, measured, first, kept.segment(first, count));
    }
    if (take) {
      take({first, log.q.middleCols(first, count), log.qd.middleCols(first, count),
            result.accelerations.qdd.middleCols(first, count), computed, measured});
    }
  });
  if (recorded) {
    result.errors = all.metrics();
    result.errors_of_kept = of_kept.metrics();
  }
}

void append(std::vector<std::string>& notes, const std::vector<std::string>& more) {
  notes.insert(notes.end(), more.begin(), more.end());
}

}  // namespace

Evaluation evaluate(const JointLogView& log, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const TakeSamples& take) {
  Evaluation result;
  result.joint_names = solver.jointNames();
  result.effort = statedEffort(options.effort);
  Stopwatch watch;
  result.accelerations = accelerationsOf(log, options);
  result.acceleration_seconds = watch.lap();
  const Torques torques(log, solver, result.accelerations.qdd, options);
  if (result.effort.meaning == kAutomatic) {
    result.effort = effortOfData(
        verdictOf(torques, log, result.accelerations.samples.kept, options.effort), options.effort);
  }
  compare(torques, log, take, result);
  result.torque_seconds = watch.lap();

  append(result.notes, solver.warnings());
  append(result.notes, options.notes);
  const bool all_zero = log.effort.size() > 0 && log.effort.isZero(0);
  append(result.notes, effortNotes(result.effort, options.effort, all_zero, driveGainsOf(solver)));
  append(result.notes, result.accelerations.findings);
  return result;
}

SampleRules rulesWithout(const std::vector<std::string>& names) {
  SampleRules rules;
  const std::vector<std::pair<std::string, bool*>> known = {
      {"repeated", &rules.repeated},
      {"non-increasing", &rules.non_increasing},
      {"time-base", &rules.time_base},
      {"start-transient", &rules.start_transient}};
  for (const std::string& name : names) {
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const auto& rule) { return rule.first == name; });
    if (found == known.end()) {
      throw EvaluationError(
          "rules: expected some of repeated, non-increasing, time-base, start-transient, got '" +
          name + "'");
    }
    *found->second = false;
  }
  return rules;
}

void requirePossibleTorques(const std::string& where, const std::vector<std::string>& joint_names,
                            const std::vector<std::string>& units,
                            const Eigen::Ref<const Eigen::MatrixXd>& computed, Index first) {
  const auto joints = static_cast<std::size_t>(computed.rows());
  if (joint_names.size() != joints || (!units.empty() && units.size() != joints)) {
    throw EvaluationError(
        where, "names and units of joints",
        std::to_string(joints) + " of both, as torques have rows",
        std::to_string(joint_names.size()) + " names, " + std::to_string(units.size()) + " units",
        "units may be left out");
  }
  for (Index k = 0; k < computed.cols(); ++k) {
    for (Index j = 0; j < computed.rows(); ++j) {
      const auto joint = static_cast<std::size_t>(j);
      if (!(std::abs(computed(j, k)) <= kLargestNumber)) {
        throw EvaluationError(
            where + ": sample " + std::to_string(first + k + 1) + ": computed torque of joint " +
            joint_names[joint] + ": expected at most " + formatted("%g", kLargestNumber) +
            (units.empty() ? "" : " " + units[joint]) + ", got " + formatted("%g", computed(j, k)) +
            "; check masses, gravity and units");
      }
    }
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
