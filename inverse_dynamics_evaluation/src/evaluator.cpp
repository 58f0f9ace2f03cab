// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/evaluator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "accelerated_samples.hpp"
#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "spooled_samples.hpp"
#include "unwrapper.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using inverse_dynamics_solver::InverseDynamicsSolver;

// Parts of the work, in units of a pass that looks at the samples only.
constexpr double kLookWeight = 1.0;
constexpr double kVerdictWeight = 2.0;
constexpr double kTorquesWeight = 5.0;  // with whatever takes the result

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

// Tells the share of several passes that is done.
class Progress {
 public:
  /// @param passes  weights of all passes together. @param tell  must outlive it; may be empty.
  Progress(double passes, const TellProgress& tell) : passes_(passes), tell_(tell) {}

  /// What the next passes count for.
  void setWeight(double weight) { weight_ = weight; }
  /// A pass begins; what another one has looked at without reaching its end doesn't count.
  void begin() { share_ = 0; }
  /// So much of the pass is done.
  void reach(double share) {
    share_ = std::max(share_, std::min(share, 1.0));
    told_ = std::max(told_, std::min((done_ + weight_ * share_) / passes_, 1.0));
    if (tell_) {
      tell_(told_);
    }
  }
  /// The pass is at its end.
  void end() {
    done_ += weight_;
    share_ = 0;
  }
  /// So are all.
  void finish() {
    if (tell_) {
      tell_(1.0);
    }
  }

 private:
  double passes_;
  const TellProgress& tell_;
  double weight_ = kLookWeight;
  double done_ = 0;   // weights of the passes that are at their end
  double share_ = 0;  // of this pass
  double told_ = 0;
};

// Another source, whose messages are counted: those before a time window take time too.
class ObservedSource : public JointStateSource {
 public:
  ObservedSource(JointStateSource& source, Progress& progress)
      : source_(source),
        progress_(progress),
        expected_(std::max(static_cast<double>(source.expectedMessages()), 1.0)) {}

  bool next(JointStateBlock& block) override {
    const bool found = source_.next(block);
    if (found) {
      read_ += static_cast<double>(block.size());
      progress_.reach(read_ / expected_);
    }
    return found;
  }
  void rewind() override {
    source_.rewind();
    read_ = 0;
  }
  std::int64_t expectedMessages() const override { return source_.expectedMessages(); }
  std::string where() const override { return source_.where(); }

 private:
  JointStateSource& source_;
  Progress& progress_;
  double expected_;
  double read_ = 0;
};

// Another stream with unwrapped positions, whose progress is told and whose time is taken.
class ObservedSamples : public SampleStream {
 public:
  ObservedSamples(SampleStream& samples, Unwrapper unwrapper, double expected, Progress& progress)
      : samples_(samples),
        unwrapper_(std::move(unwrapper)),
        progress_(progress),
        expected_(std::max(expected, 1.0)) {}

  bool next(SampleBlock& block) override {
    Stopwatch watch;
    const bool found = samples_.next(block);
    seconds_ += watch.lap();
    if (found) {
      unwrapper_.unwrap(block);
      given_ += static_cast<double>(block.size());
      progress_.reach(given_ / expected_);
    } else {
      expected_ = std::max(given_, 1.0);
      if (!std::exchange(ended_, true)) {
        progress_.end();
      }
    }
    return found;
  }
  void rewind() override {
    samples_.rewind();
    unwrapper_.rewind();
    given_ = 0;
    ended_ = false;
    progress_.begin();
  }
  bool clockHasChanged() override { return samples_.clockHasChanged(); }
  Clock clock() const override { return samples_.clock(); }
  std::string where() const override { return samples_.where(); }
  std::string frameId() const override { return samples_.frameId(); }

  const Unwrapper& unwrapper() const { return unwrapper_; }

  /// How long reading took.
  double seconds() const { return seconds_; }

 private:
  SampleStream& samples_;
  Unwrapper unwrapper_;
  Progress& progress_;
  double expected_;   // samples
  double given_ = 0;  // in this pass
  bool ended_ = false;
  double seconds_ = 0;
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
MatrixXd keptColumns(const Eigen::Ref<const MatrixXd>& columns, const Flags& mask) {
  MatrixXd result(columns.rows(), mask.count());
  Index next = 0;
  for (Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) {
      result.col(next++) = columns.col(k);
    }
  }
  return result;
}

// Weights of all passes together.
double passes(const EvaluationOptions& options) {
  return (options.cutoff == 0 ? 3.0 : 2.0) * kLookWeight + kTorquesWeight +
         (statedEffort(options.effort).meaning == kAutomatic ? kVerdictWeight : 0.0);
}

// An evaluation of samples from wherever they come.
class Evaluator {
 public:
  Evaluator(SampleStream& samples, double expected, const InverseDynamicsSolver& solver,
            const EvaluationOptions& options, Progress& progress)
      : solver_(solver),
        options_(options),
        stated_(statedEffort(options.effort)),
        progress_(progress),
        samples_(samples, Unwrapper(solver.jointTypes()), expected, progress) {}

  /// @param gather  whether the result gets what there is of each sample.
  Evaluation evaluate(const TakeSamples& take, bool gather) {
    Evaluation result;
    result.joint_names = solver_.jointNames();
    result.effort = stated_;
    AccelerationOptions accelerations;
    accelerations.method = options_.method;
    accelerations.cutoff = options_.cutoff;
    accelerations.rules = options_.rules;
    plan_ = named(options_, [&] { return planAccelerations(samples_, accelerations); });
    result.accelerations = withoutSeries(samples_, plan_);
    acceleration_seconds_ = watch_.lap() - samples_.seconds();
    if (stated_.meaning == kAutomatic) {
      progress_.setWeight(kVerdictWeight);
      result.effort = effortOfData(verdict(), options_.effort);
    }
    progress_.setWeight(kTorquesWeight);
    compare(take, gather, result);
    result.reading_seconds = samples_.seconds();
    result.acceleration_seconds = acceleration_seconds_;
    result.torque_seconds = torque_seconds_;
    addNotes(result);
    progress_.finish();
    return result;
  }

 private:
  // Calls `visit` with all samples, 4096 at a time, and their computed torques.
  template <class Visit>
  void forEachBlock(Visit visit) {
    AcceleratedSamples samples(samples_, plan_);
    TimedBlock block;
    watch_.lap();
    for (double read = samples_.seconds(); samples.next(block); read = samples_.seconds()) {
      acceleration_seconds_ += watch_.lap() - (samples_.seconds() - read);
      const MatrixXd computed = solver_.getTorquesBatch(block.q, block.qd, block.qdd);
      requirePossibleTorques(options_.recording, solver_.jointNames(), options_.units, computed,
                             block.first);
      visit(block, computed);
      watch_.lap();
    }
  }

  MatrixXd gravity(const TimedBlock& block) const { return solver_.getGravityVectorBatch(block.q); }

  EffortVerdict verdict() {
    const bool recorded = plan_.census.efforts;
    EffortSums sums(recorded ? plan_.found.report.counts.kept : 0, plan_.census.joints,
                    options_.effort.drive_gains);
    if (recorded) {
      forEachBlock([&](const TimedBlock& block, const MatrixXd& computed) {
        sums.add(keptColumns(computed, block.kept), keptColumns(gravity(block), block.kept),
                 keptColumns(block.effort, block.kept));
        torque_seconds_ += watch_.lap();
      });
    }
    return sums.verdict();
  }

  // Errors of the computed torques, once it is known what efforts mean; hands over the series.
  void compare(const TakeSamples& take, bool gather, Evaluation& result) {
    const bool recorded = plan_.census.efforts;
    const Index all = plan_.census.counts.all;
    OwnedMatrix qdd(plan_.census.joints, gather ? all : 0);
    SampleSeries series(gather ? all : 0);
    ErrorSums errors(plan_.census.joints);
    ErrorSums of_kept(plan_.census.joints);
    forEachBlock([&](const TimedBlock& block, MatrixXd computed) {
      if (result.effort.meaning == kTorqueWithoutGravity) {
        computed -= gravity(block);
      }
      OwnedMatrix measured;
      if (recorded) {
        measured = result.effort.torques(block.effort);
        errors.add(computed, measured, block.first);
        of_kept.add(computed, measured, block.first, Mask(block.kept));
      }
      torque_seconds_ += watch_.lap();
      if (gather) {
        qdd.middleCols(block.first, block.size()) = block.qdd;
        series.add(block);
      }
      if (take) {
        take({block.first, all, block.header_stamps, block.receive_stamps, block.time, block.q,
              block.qd, block.qdd, block.effort, computed, measured, block.repeated,
              block.non_increasing, block.start_transient, block.isolated, block.kept,
              samples_.frameId()});
      }
    });
    if (gather) {
      result.accelerations.qdd = std::move(qdd);
      series.moveTo(result.accelerations.samples);
    }
    if (recorded) {
      result.errors = errors.metrics();
      result.errors_of_kept = of_kept.metrics();
    }
  }

  void addNotes(Evaluation& result) const {
    const auto add = [&](const std::vector<std::string>& more) {
      result.notes.insert(result.notes.end(), more.begin(), more.end());
    };
    add(solver_.warnings());
    add(options_.notes);
    const bool all_zero = plan_.census.efforts && plan_.census.all_zero;
    add(effortNotes(result.effort, options_.effort, all_zero, driveGainsOf(solver_)));
    add(result.accelerations.findings);
    add(samples_.unwrapper().findings(result.joint_names));
  }

  const InverseDynamicsSolver& solver_;
  const EvaluationOptions& options_;
  Effort stated_;
  Progress& progress_;
  ObservedSamples samples_;
  AccelerationPlan plan_;
  Stopwatch watch_;
  double acceleration_seconds_ = 0, torque_seconds_ = 0;
};

}  // namespace

Evaluation evaluate(const JointLogView& log, const InverseDynamicsSolver& solver,
                    const EvaluationOptions& options, const TakeSamples& take) {
  named(options, [&] { checkLog(log); });
  SamplesInMemory samples(log, log.time());
  Progress progress(passes(options), options.progress);
  const auto expected = static_cast<double>(log.q.cols());
  return Evaluator(samples, expected, solver, options, progress).evaluate(take, true);
}

Evaluation evaluate(JointStateSource& source, const RecordingOptions& recording,
                    const InverseDynamicsSolver& solver, const EvaluationOptions& options,
                    const TakeSamples& take) {
  Progress progress(passes(options), options.progress);
  auto observed = std::make_unique<ObservedSource>(source, progress);
  std::unique_ptr<JointStateSource> part;
  if (recording.window.isBounded()) {
    part = std::make_unique<TimeWindow>(std::move(observed), recording.window, recording.joints,
                                        recording.clock);
  } else {
    part = std::move(observed);
  }
  RecordedSamples samples(*part, recording.joints, recording.clock, recording.log);
  std::optional<SpooledSamples> spooled;
  if (!recording.scratch.empty()) {
    spooled.emplace(samples, recording.scratch);
  }
  SampleStream& stream = spooled ? static_cast<SampleStream&>(*spooled) : samples;
  const auto expected = static_cast<double>(source.expectedMessages());
  Evaluation result = Evaluator(stream, expected, solver, options, progress).evaluate(take, false);
  result.recording = samples.about();
  const auto before_efforts = solver.warnings().size() + options.notes.size();
  result.notes.insert(result.notes.begin() + static_cast<std::ptrdiff_t>(before_efforts),
                      result.recording.notes.begin(), result.recording.notes.end());
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
