// SPDX-License-Identifier: Apache-2.0

// An evaluation of a recording that is read several times, in blocks, against that of samples in
// memory.

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "distance_counts.hpp"
#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/evaluator.hpp"
#include "motion.hpp"
#include "two_joint_solver.hpp"

namespace inverse_dynamics_evaluation::stream_test {

namespace fs = std::filesystem;
using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A log as messages, in blocks of any length; joint b before joint a, and a gripper's messages.
class Messages : public JointStateSource {
 public:
  Messages(const JointLog& log, Index block) : log_(log), block_(block) {}

  bool next(JointStateBlock& block) override {
    const Index all = passes < fails_in ? log_.q.cols() : ends_at;
    const Index count = std::min(block_, all - next_);
    if (count <= 0) {
      return false;
    }
    block = JointStateBlock();
    block.first = next_;
    block.joint_names = {"b", "a"};
    block.frame_id = "base";
    const auto field = [&](const OwnedMatrix& numbers, JointStateNumbers& to) {
      to.columns = 2;
      to.values.resize(static_cast<std::size_t>(2 * count));
      Eigen::Map<MatrixXd>(to.values.data(), 2, count) =
          numbers.middleCols(next_, count).colwise().reverse();
    };
    field(log_.q, block.position);
    field(log_.qd, block.velocity);
    field(log_.effort, block.effort);
    for (Index k = next_; k < next_ + count; ++k) {
      block.header_stamps.push_back(log_.header_stamps[k]);
      block.receive_stamps.push_back(log_.receive_stamps[k]);
    }
    if (passes >= fails_in && change) {
      change(block);
    }
    next_ += count;
    return true;
  }
  void rewind() override {
    next_ = 0;
    ++passes;
  }
  std::int64_t expectedMessages() const override { return log_.q.cols(); }
  std::string where() const override { return "bag: /joint_states"; }

  int passes = 0;     // that were begun, by rewind()
  int fails_in = 99;  // pass from which on the recording is another one
  Index ends_at = 0;
  std::function<void(JointStateBlock&)> change;

 private:
  const JointLog& log_;
  Index block_;
  Index next_ = 0;
};

void flipBit(double& number, unsigned bit) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  bits ^= std::uint64_t{1} << bit;
  std::memcpy(&number, &bits, sizeof bits);
}

JointLog logOf(const Motion& motion) {
  JointLog log;
  log.joint_names = {"a", "b"};
  log.header_stamps = (motion.time * 1e9).array().round().cast<std::int64_t>();
  log.header_stamps.array() += 1'700'000'000'000'000'000;
  log.receive_stamps = log.header_stamps;
  log.receive_stamps.array() += 1'000'000;
  log.q = motion.q;
  log.qd = motion.qd;
  log.effort = motion.effort;
  return log;
}

Motion noisy(double rate, double seconds) {
  Motion motion = sines(rate, seconds, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  return motion;
}

// Everything that is odd about recordings, one by one.
std::vector<std::pair<std::string, JointLog>> oddRecordings() {
  std::vector<std::pair<std::string, JointLog>> all;
  const auto add = [&](const std::string& what, const Motion& motion) {
    all.emplace_back(what, logOf(motion));
  };
  const Motion clean = noisy(125.0, 80.0);
  add("clean", clean);
  add("repeats", withRepeats(clean, 10));
  Motion motion = clean;
  motion.time.tail(6000).array() += 3.0;
  motion.time.tail(5995).array() += 2.0;  // five samples between two gaps
  add("gaps", motion);
  motion = clean;
  motion.time[4096] = motion.time[4095];
  motion.time.segment(4090, 5).array() -= 0.5;
  motion.time.tail(1).array() -= 1.0;
  add("backward stamps", motion);
  motion = clean;
  for (Index k = 0; k < 20; ++k) {
    motion.effort(0, k) += k % 2 == 0 ? 800.0 : -800.0;
  }
  add("start transient", motion);
  motion = clean;
  jitterStamps(motion, 0.8, 2);
  add("regular", motion);
  std::vector<Index> samples;
  for (Index k = 0; k < clean.count(); ++k) {
    samples.push_back(k - k / 25);
  }
  add("regular fresh", pick(clean, samples, 0.96 * clean.time));
  motion = clean;
  motion.time.segment(3000, 4000).array() -= 40.0;  // a clock that was set back
  add("clock set back", motion);
  return all;
}

EvaluationOptions options(const std::string& effort = kTorque) {
  EvaluationOptions options;
  options.effort.option = effort;
  options.recording = "bag";
  options.topic = "/joint_states";
  return options;
}

// All that is handed over.
struct Series {
  explicit Series(Index count)
      : q(2, count), qdd(2, count), computed(2, count), measured(2, count), kept(count) {}
  TakeSamples take() {
    return [this](const EvaluatedSamples& next) {
      EXPECT_EQ(next.first, taken);
      EXPECT_EQ(next.all, q.cols());
      const Index count = next.q.cols();
      q.middleCols(taken, count) = next.q;
      qdd.middleCols(taken, count) = next.qdd;
      computed.middleCols(taken, count) = next.computed;
      measured.middleCols(taken, count) = next.measured;
      kept.segment(taken, count) = next.kept;
      taken += count;
    };
  }
  MatrixXd q, qdd, computed, measured;
  Eigen::Array<bool, Eigen::Dynamic, 1> kept;
  Index taken = 0;
};

RecordingOptions joints(const std::string& scratch = "") {
  RecordingOptions options;
  options.joints = {"a", "b"};
  options.scratch = scratch;
  return options;
}

TEST(Stream, GivesTheBitsOfSamplesInMemoryWhateverTheBlocks) {
  const TwoJointSolver solver;
  for (const auto& [what, log] : oddRecordings()) {
    SCOPED_TRACE(what);
    const Index count = log.q.cols();
    Series whole(count);
    const Evaluation expected = evaluate(log, solver, options(kAutomatic), whole.take());
    EXPECT_EQ(whole.taken, count);
    for (const Index block : {Index{1}, Index{7}, Index{4096}, Index{4097}, count}) {
      SCOPED_TRACE(block);
      const bool spooled = block == 7;
      Messages messages(log, block);
      Series series(count);
      const Evaluation found = evaluate(messages, joints(spooled ? testing::TempDir() : ""), solver,
                                        options(kAutomatic), series.take());
      EXPECT_EQ(messages.passes, spooled ? 1 : 6);
      EXPECT_EQ(series.taken, count);
      EXPECT_EQ(series.q, whole.q);
      EXPECT_EQ(series.qdd, whole.qdd);
      EXPECT_EQ(series.computed, whole.computed);
      EXPECT_EQ(series.measured, whole.measured);
      EXPECT_TRUE((series.kept == whole.kept).all());
      EXPECT_EQ(found.notes, expected.notes);
      EXPECT_EQ(found.errors[1].rmse, expected.errors[1].rmse);
      EXPECT_EQ(found.errors_of_kept[1].rmse, expected.errors_of_kept[1].rmse);
      EXPECT_EQ(found.accelerations.filter.cutoff, expected.accelerations.filter.cutoff);
      EXPECT_EQ(found.accelerations.samples.counts.kept, whole.kept.count());
      EXPECT_EQ(found.recording.frame_id, "base");
    }
  }
}

TEST(Stream, FindsWhatIsOdd) {
  const TwoJointSolver solver;
  std::vector<std::string> bases;
  for (const auto& [what, log] : oddRecordings()) {
    const Evaluation found = evaluate(log, solver, options());
    const SampleReport& report = found.accelerations.samples;
    bases.push_back(name(report.time_base));
    EXPECT_EQ(report.counts.repeated, report.repeated.count()) << what;
    EXPECT_EQ(report.counts.non_increasing, report.non_increasing.count()) << what;
    EXPECT_EQ(report.counts.start_transient, report.start_transient.count()) << what;
    EXPECT_EQ(report.counts.isolated, report.isolated.count()) << what;
    EXPECT_EQ(report.counts.kept, report.kept.count()) << what;
    for (Index k = 1; k < report.time.size(); ++k) {
      ASSERT_LE(report.time[k - 1], report.time[k]) << what << k;
    }
  }
  EXPECT_THAT(bases, ElementsAre("stamps", "stamps", "stamps", "stamps", "stamps", "regular",
                                 "regular_fresh", "stamps"));
}

TEST(Stream, TakesTheTimeOfReceptionIfNoHeaderHasAStamp) {
  JointLog log = logOf(noisy(125.0, 20.0));
  log.header_stamps.setZero();
  for (const std::string& scratch : {std::string(), testing::TempDir()}) {
    Messages messages(log, 100);
    log.clock = Clock::kHeader;
    const Evaluation found = evaluate(messages, joints(scratch), TwoJointSolver(), options());
    EXPECT_EQ(found.recording.clock, Clock::kReceive);
    EXPECT_THAT(found.recording.notes, ElementsAre(HasSubstr("time of reception")));
    log.clock = Clock::kReceive;
    EXPECT_EQ(found.errors[0].rmse, evaluate(log, TwoJointSolver(), options()).errors[0].rmse);
  }
}

TEST(Stream, TellsWhyTheSamplesCannotBeKept) {
  const JointLog log = logOf(noisy(125.0, 20.0));
  Messages messages(log, 100);
  EXPECT_THAT(errorOf<RecordingError>([&] {
                evaluate(messages, joints("/no/such/directory"), TwoJointSolver(), options());
              }),
              HasSubstr("/no/such/directory: can't be written (No such file or directory); free "
                        "some space, or name another output"));
}

TEST(Stream, TellsOfTheProgressAndCanBeStopped) {
  const JointLog log = logOf(noisy(125.0, 80.0));
  Messages messages(log, 1000);
  EvaluationOptions told = options();
  std::vector<double> shares;
  told.progress = [&](double share) { shares.push_back(share); };
  evaluate(messages, joints(), TwoJointSolver(), told);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.size(), 8U);
  EXPECT_NEAR(shares.back(), 1.0, 0.1);
  told.progress = [](double share) {
    if (share > 0.5) {
      throw std::runtime_error("stopped");
    }
  };
  messages.rewind();
  EXPECT_THROW(evaluate(messages, joints(), TwoJointSolver(), told), std::runtime_error);
}

TEST(Stream, RefusesARecordingThatChangesWhileItIsRead) {
  const JointLog log = logOf(withRepeats(noisy(125.0, 80.0), 10));
  const auto evaluated = [&](const auto& prepare) {
    Messages messages(log, 1000);
    prepare(messages);
    return errorOf<RecordingError>(
        [&] { evaluate(messages, joints(), TwoJointSolver(), options()); });
  };
  for (const int pass : {2, 3, 4, 5}) {
    SCOPED_TRACE(pass);
    EXPECT_THAT(evaluated([&](Messages& messages) {
                  messages.fails_in = pass;
                  messages.ends_at = 4500;
                }),
                HasSubstr("bag: /joint_states: expected the same samples each time it is read"));
    EXPECT_THAT(evaluated([&](Messages& messages) {
                  messages.fails_in = pass;
                  messages.ends_at = log.q.cols();
                  messages.change = [](JointStateBlock& block) {
                    std::fill(block.velocity.values.begin(), block.velocity.values.end(), 0.1);
                    std::fill(block.position.values.begin(), block.position.values.end(), 0.1);
                    std::fill(block.effort.values.begin(), block.effort.values.end(), 0.1);
                  };
                }),
                HasSubstr("expected the same samples each time it is read"));
    EXPECT_THAT(evaluated([&](Messages& messages) {
                  messages.fails_in = pass;
                  messages.ends_at = log.q.cols();
                  messages.change = [](JointStateBlock& block) { block.position.values[0] += 0.1; };
                }),
                HasSubstr("expected the same samples each time it is read"));
    EXPECT_THAT(evaluated([&](Messages& messages) {  // bits of two numbers, side by side
                  messages.fails_in = pass;
                  messages.ends_at = log.q.cols();
                  messages.change = [](JointStateBlock& block) {
                    flipBit(block.position.values[1], 3);
                    flipBit(block.position.values[0], 10);
                  };
                }),
                HasSubstr("expected the same samples each time it is read"));
  }
}

// Cuts off the file without a name in a directory.
void truncateUnnamedFile(const std::string& directory) {
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string target = fs::read_symlink(entry, gone);
    if (target.rfind(directory, 0) == 0 && target.find(" (deleted)") != std::string::npos) {
      ASSERT_EQ(truncate(entry.path().c_str(), 0), 0);
      return;
    }
  }
  FAIL() << "no such file";
}

TEST(Stream, SaysThatItsFileOfSamplesCantBeReadAgain) {
  const std::string directory = fs::canonical(testing::TempDir());
  const JointLog log = logOf(noisy(125.0, 80.0));
  Messages messages(log, 1000);
  EvaluationOptions raw = options();
  raw.method = AccelerationMethod::kBackwardDifference;
  bool first = true;
  EXPECT_THAT(errorOf<RecordingError>([&] {
                evaluate(messages, joints(directory), TwoJointSolver(), raw,
                         [&](const EvaluatedSamples&) {
                           if (std::exchange(first, false)) truncateUnnamedFile(directory);
                         });
              }),
              HasSubstr(directory + ": the samples written there can't be read again ("));
}

TEST(Stream, TellsTheProgressUpToATimeWindowAndItsEnd) {
  const JointLog log = logOf(noisy(125.0, 80.0));
  Messages messages(log, 100);
  RecordingOptions part = joints();
  part.window = {70.0, 75.0};
  EvaluationOptions watched = options();
  std::vector<double> shares;
  watched.progress = [&](double share) { shares.push_back(share); };
  std::size_t told_before = 0;
  const auto take = [&](const EvaluatedSamples&) {
    if (told_before == 0) told_before = shares.size();
  };
  evaluate(messages, part, TwoJointSolver(), watched, take);
  EXPECT_GT(told_before, 300U);  // the whole recording, three times
  EXPECT_LT(shares.front(), 0.01);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(DistanceCounts, AreExactForFewDifferentDistances) {
  DistanceCounts counts;
  std::mt19937 generator(1);
  std::vector<double> all;
  for (int i = 0; i < 300000; ++i) {
    const auto distance = static_cast<std::int64_t>(8'000'000 + generator() % 50000);
    counts.add(i % 1000 == 0 ? 100 * distance : distance);
    all.push_back(static_cast<double>(i % 1000 == 0 ? 100 * distance : distance));
  }
  std::sort(all.begin(), all.end());
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(counts.quantile(0.5, none), all[149999]);
  EXPECT_EQ(counts.quantile(0.0, none), all.front());
  EXPECT_EQ(counts.quantile(1.0, none), all.back());
  EXPECT_EQ(counts.count(1e7), 299700);
  EXPECT_NEAR(counts.mean(1e7), 8'025'000, 100);
  EXPECT_NEAR(counts.deviation(1e7), 50000 / std::sqrt(12.0), 50);
}

TEST(DistanceCounts, AreCloseForAnyNumberOfDifferentDistances) {
  DistanceCounts counts;
  std::mt19937_64 generator(2);
  for (int i = 0; i < 1000000; ++i) {
    counts.add(static_cast<std::int64_t>(generator() % 1'000'000'000) - 500'000'000);
  }
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(counts.quantile(0.9, none), 400e6, 1e6);
  EXPECT_NEAR(counts.mean(none), 0, 1e6);
  EXPECT_EQ(counts.count(none), 1000000);
}

}  // namespace inverse_dynamics_evaluation::stream_test
