// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/evaluator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "examination.hpp"
#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "table_accelerations.hpp"
#include "turns.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using inverse_dynamics_solver::InverseDynamicsSolver;

// Samples that a solver gets at once: whole groups of those that it computes in parallel, and few
// enough to stay in the cache.
constexpr Index kSamplesAtOnce = 4096;

// Shares of the work that are done after each part of it, about as long as they take.
constexpr double kRead = 0.4;
constexpr double kAccelerated = 0.6;
constexpr double kComputed = 0.85;

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
template <class Call>
auto named(const EvaluationOptions& options, Call call) {
  try {
    return call();
  } catch (const EvaluationError& error) {
    const std::string topic = options.topic.empty() ? "" : ": " + options.topic;
    throw EvaluationError(options.recording + topic + ": " + error.what());
  }
}

// The columns where `mask` is true.
MatrixXd keptColumns(const Eigen::Ref<const MatrixXd>& columns,
                     const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& mask) {
  MatrixXd result(columns.rows(), mask.count());
  Index next = 0;
  for (Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) {
      result.col(next++) = columns.col(k);
    }
  }
  return result;
}

// Evaluates a table that has what was recorded.
class Evaluator {
 public:
  Evaluator(SampleTable& table, const InverseDynamicsSolver& solver,
            const EvaluationOptions& options)
      : table_(table), solver_(solver), options_(options) {}

  /// Adds all that comes of it to what is known: what efforts are stated to mean, the recording.
  void evaluate(Evaluation& result) {
    result.joint_names = solver_.jointNames();
    Stopwatch watch;
    const std::vector<std::string> jumps =
        unwrapPositions(table_, solver_.jointTypes(), result.joint_names);
    AccelerationOptions accelerations;
    accelerations.method = options_.method;
    accelerations.cutoff = options_.cutoff;
    accelerations.rules = options_.rules;
    result.accelerations =
        named(options_, [&] { return findAccelerations(table_, accelerations); });
    result.acceleration_seconds = watch.lap();
    computeTorques();
    const bool recorded = table_.effort.size() > 0;
    if (result.effort.meaning == kAutomatic) {
      result.effort = effortOfData(verdict(result.accelerations.samples), options_.effort);
    }
    if (result.effort.meaning == kTorqueWithoutGravity) {
      forEachBlock(kComputed, kComputed, [&](Index first, Index count) {
        table_.computed.middleCols(first, count) -= gravity(first, count);
      });
    }
    if (recorded) {
      compare(result);
    }
    result.torque_seconds = watch.lap();
    addNotes(result, jumps);
    tell(1.0);
  }

 private:
  void tell(double share) const {
    if (options_.progress) {
      options_.progress(share);
    }
  }

  // Calls `visit` with number and count of some samples at a time, until all were visited.
  template <class Visit>
  void forEachBlock(double share, double end_share, Visit visit) const {
    const Index all = table_.size();
    for (Index first = 0; first < all; first += kSamplesAtOnce) {
      tell(share + (end_share - share) * static_cast<double>(first) / static_cast<double>(all));
      visit(first, std::min(kSamplesAtOnce, all - first));
    }
  }

  MatrixXd gravity(Index first, Index count) const {
    return solver_.getGravityVectorBatch(table_.q.middleCols(first, count));
  }

  void computeTorques() {
    forEachBlock(kAccelerated, kComputed, [&](Index first, Index count) {
      auto computed = table_.computed.middleCols(first, count);
      solver_.getTorquesBatch(table_.q.middleCols(first, count), table_.qd.middleCols(first, count),
                              table_.qdd.middleCols(first, count), computed);
      requirePossibleTorques(options_.recording, solver_.jointNames(), options_.units, computed,
                             first);
    });
  }

  // What efforts mean by the data.
  EffortVerdict verdict(const SampleReport& samples) const {
    const bool recorded = table_.effort.size() > 0;
    EffortSums sums(recorded ? samples.counts.kept : 0, table_.q.rows(),
                    options_.effort.drive_gains);
    if (recorded) {
      forEachBlock(kComputed, kComputed, [&](Index first, Index count) {
        const auto kept = table_.kept.segment(first, count);
        sums.add(keptColumns(table_.computed.middleCols(first, count), kept),
                 keptColumns(gravity(first, count), kept),
                 keptColumns(table_.effort.middleCols(first, count), kept));
      });
    }
    return sums.verdict();
  }

  // Measured torques, once it is known what efforts mean, and errors.
  void compare(Evaluation& result) const {
    ErrorSums errors(table_.q.rows());
    ErrorSums of_kept(table_.q.rows());
    forEachBlock(kComputed, 1.0, [&](Index first, Index count) {
      const auto computed = table_.computed.middleCols(first, count);
      auto measured = table_.measured.middleCols(first, count);
      measured = result.effort.torques(table_.effort.middleCols(first, count));
      errors.add(computed, measured, first);
      of_kept.add(computed, measured, first, Mask(table_.kept.segment(first, count)));
    });
    result.errors = errors.metrics();
    result.errors_of_kept = of_kept.metrics();
  }

  void addNotes(Evaluation& result, const std::vector<std::string>& jumps) const {
    const auto add = [&](const std::vector<std::string>& more) {
      result.notes.insert(result.notes.end(), more.begin(), more.end());
    };
    add(solver_.warnings());
    add(options_.notes);
    add(result.recording.notes);
    const bool all_zero = table_.effort.size() > 0 && table_.effort.isZero(0);
    add(effortNotes(result.effort, options_.effort, all_zero, driveGainsOf(solver_)));
    add(result.accelerations.findings);
    add(jumps);
  }

  SampleTable& table_;
  const InverseDynamicsSolver& solver_;
  const EvaluationOptions& options_;
};

}  // namespace

Evaluation evaluate(const JointLogView& log, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options) {
  named(options, [&] { checkLog(log); });
  Evaluation result;
  result.effort = statedEffort(options.effort);
  result.table = tableOf(log);
  Evaluator(*result.table, solver, options).evaluate(result);
  return result;
}

Evaluation evaluate(JointStateSource& source, const RecordingOptions& recording,
                    const InverseDynamicsSolver& solver, const EvaluationOptions& options) {
  Stopwatch watch;
  Evaluation result;
  result.effort = statedEffort(options.effort);
  result.table = std::make_shared<SampleTable>(recording.scratch);
  TellProgress progress;
  if (options.progress) {
    progress = [&](double share) { options.progress(kRead * share); };
  }
  result.recording = readTable(source, recording, *result.table, progress);
  result.reading_seconds = watch.lap();
  Evaluator(*result.table, solver, options).evaluate(result);
  return result;
}

void checkOptions(const EvaluationOptions& options) {
  checkCutoff(options.method, options.cutoff);
  statedEffort(options.effort);
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
