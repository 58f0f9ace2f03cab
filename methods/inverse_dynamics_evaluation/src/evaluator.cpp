// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/evaluator.hpp"

#include <algorithm>
#include <chain_dynamics/friction_state.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "figures.hpp"
#include "filtering.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using inverse_dynamics_solver::InverseDynamicsSolver;

// Samples per call of a solver: a multiple of its lanes, and few enough to stay in the cache.
constexpr Index kSamplesAtOnce = 4096;

// Share of the work that is done after each step, by typical running times.
constexpr double kRead = 0.4;
constexpr double kAccelerated = 0.6;
constexpr double kComputed = 0.85;
constexpr double kMeasured = 0.9;

// Names the recording in errors.
template <class Call>
auto named(const EvaluationOptions& options, Call call) {
  try {
    return call();
  } catch (const EvaluationError& error) {
    const std::string topic = options.topic.empty() ? "" : ": " + options.topic;
    throw EvaluationError(options.recording + topic + ": " + error.what());
  }
}

// Refuses columns of different lengths, fewer than two samples, and numbers that aren't finite.
void check(const RecordedColumns& columns) {
  const auto& [header_stamps, receive_stamps, clock, q, qd, effort, qdd] = columns;
  requireSamples("samples", "qd", qd, 2);
  requireStampPerSample("samples", header_stamps.cast<double>(), qd);
  checkSamples(receive_stamps.cast<double>(), q, qd, effort);
  if (qdd.size() > 0) requireSameSize("samples", "qdd", qdd, "qd", qd);
}

// Calls `visit` with number and count of some samples at a time, and tells the progress to `share`.
template <class Visit>
void forEachBlock(Index samples, const EvaluationOptions& options, double share, double end_share,
                  Visit visit) {
  for (Index first = 0; first < samples; first += kSamplesAtOnce) {
    if (options.progress) {
      options.progress(share + (end_share - share) * static_cast<double>(first) /
                                   static_cast<double>(samples));
    }
    visit(first, std::min(kSamplesAtOnce, samples - first));
  }
}

// Computed torques as efforts are that lack gravity.
void subtractGravity(SampleTable& table, const InverseDynamicsSolver& solver,
                     const EvaluationOptions& options) {
  const auto& subtracted = options.subtracted != nullptr ? *options.subtracted : solver;
  forEachBlock(table.size(), options, kComputed, kComputed, [&](Index first, Index count) {
    table.computed.middleCols(first, count) -=
        subtracted.getGravityVectorBatch(table.q.middleCols(first, count));
  });
}

// Measured torques, and errors of the computed ones.
void findErrors(Evaluation& result, const EvaluationOptions& options) {
  SampleTable& table = *result.table;
  forEachBlock(table.size(), options, kComputed, kMeasured, [&](Index first, Index count) {
    table.measured.middleCols(first, count) =
        result.effort.torques(table.effort.middleCols(first, count));
  });
  result.errors_of_kept = metrics(table.computed, table.measured, Mask(table.kept));
  // samples of another source have nothing to do with the robot's torques
  const bool alone = result.accelerations.samples.second_source.count == 0;
  result.errors = alone ? metrics(table.computed, table.measured) : result.errors_of_kept;
}

// Faults and accelerations of the samples of a table.
void prepare(Evaluation& result, const InverseDynamicsSolver& solver,
             const EvaluationOptions& options) {
  SampleTable& table = *result.table;
  result.effort = statedEffort(options.effort);
  result.joint_names = solver.jointNames();
  const std::vector<std::string> jumps =
      unwrapPositions(table, solver.jointTypes(), result.joint_names);
  LowPassOptions filter;
  filter.cutoff = options.cutoff;
  filter.rules = options.rules;
  filter.solver = &solver;
  result.accelerations =
      named(options, [&] { return findAccelerations(table, options.method, filter); });
  result.notes = jumps;
}

}  // namespace

Evaluation readMotion(const RecordedColumns& columns, const InverseDynamicsSolver& solver,
                      const EvaluationOptions& options) {
  named(options, [&] { check(columns); });
  Evaluation result;
  statedEffort(options.effort);  // refuses before samples are copied
  result.table = tableOf(columns);
  prepare(result, solver, options);
  return result;
}

Evaluation readMotion(JointStateSource& source, const RecordingOptions& recording,
                      const InverseDynamicsSolver& solver, const EvaluationOptions& options) {
  Evaluation result;
  statedEffort(options.effort);  // refuses before a recording is read
  result.table = std::make_shared<SampleTable>(recording.scratch);
  TellProgress progress;
  if (options.progress) progress = [&](double share) { options.progress(kRead * share); };
  readTable(source, recording, *result.table, progress);
  prepare(result, solver, options);
  return result;
}

void computeTorques(Evaluation& motion, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options) {
  SampleTable& table = *motion.table;
  chain_dynamics::FrictionState friction = inverse_dynamics_solver::frictionState(solver);
  forEachBlock(table.size(), options, kAccelerated, kComputed, [&](Index first, Index count) {
    const auto q = table.q.middleCols(first, count), qd = table.qd.middleCols(first, count);
    auto computed = table.computed.middleCols(first, count);
    solver.getTorquesBatch(q, qd, table.qdd.middleCols(first, count), computed);
    friction.addAlong(q, qd, computed);
    requirePossibleTorques(options.recording, solver.jointNames(), options.units, computed, first);
  });
}

void compareTorques(Evaluation& motion, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const EffortVerdict& verdict) {
  SampleTable& table = *motion.table;
  if (motion.effort.meaning == kAutomatic) motion.effort = effortOfData(verdict, options.effort);
  if (motion.effort.meaning == kTorqueWithoutGravity) subtractGravity(table, solver, options);
  const bool recorded = table.effort.size() > 0;
  if (recorded) findErrors(motion, options);
  const std::vector<std::string> jumps = std::move(motion.notes);
  motion.notes.clear();
  for (const std::vector<std::string>& notes :
       {solver.warnings(), options.notes, table.notes,
        effortNotes(motion.effort, options.effort, recorded && table.effort.isZero(0),
                    driveGainsOf(solver)),
        motion.accelerations.findings, jumps}) {
    motion.notes.insert(motion.notes.end(), notes.begin(), notes.end());
  }
  if (options.progress) options.progress(1.0);
}

Evaluation evaluate(const RecordedColumns& columns, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options) {
  Evaluation result = readMotion(columns, solver, options);
  computeTorques(result, solver, options);
  compareTorques(result, solver, options);
  return result;
}

Evaluation evaluate(JointStateSource& source, const RecordingOptions& recording,
                    const InverseDynamicsSolver& solver, const EvaluationOptions& options) {
  Evaluation result = readMotion(source, recording, solver, options);
  computeTorques(result, solver, options);
  compareTorques(result, solver, options);
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
